"""The Modbus client that drives an actuator and records it."""
