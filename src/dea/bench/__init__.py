"""The virtual test bench: a Modbus server around a plant."""
