from dea.configuration.identification import Identification

# What a stretch of a record without flags depends on that models come from, and what any selection
# of terms depends on.
STRETCH = [f"identification.{key}" for key in ("start", "length", "y_lags", "u_lags")]
SELECTION = [
    f"identification.{key}" for key in Identification.model_fields if key != "resamples"
]
