"""Parameters that change with time: recursive least squares and Kalman smoothing."""
