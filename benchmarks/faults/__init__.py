"""Faults put between the acquisition's command and a device, judged by the device's own record."""
