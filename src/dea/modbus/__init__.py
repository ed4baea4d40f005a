"""What bench and acquisition share of Modbus: device descriptions and register codecs."""
