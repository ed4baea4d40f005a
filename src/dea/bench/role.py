"""The role of a master, from its certificate (Modbus/TCP Security, MB-TCP-Security-v21)."""

from cryptography import x509

# The extension in which the Modbus Organization keeps a role, as one UTF8String.
ROLE = x509.ObjectIdentifier("1.3.6.1.4.1.50316.802.1")
_UTF8_STRING = 0x0C
_SHORT = 0x80  # lengths below it take one byte


def role(certificate: bytes) -> str | None:
    """Return the role in a certificate (DER), or ``None`` if it names none or is not readable."""
    try:
        extension = x509.load_der_x509_certificate(certificate).extensions.get_extension_for_oid(
            ROLE
        )
    except (ValueError, x509.ExtensionNotFound, x509.DuplicateExtension):
        return None
    value = extension.value
    if not isinstance(value, x509.UnrecognizedExtension):
        return None
    tag, length, text = value.value[:1], value.value[1:2], value.value[2:]
    if tag != bytes([_UTF8_STRING]) or length != bytes([len(text) % 256]) or len(text) >= _SHORT:
        return None
    try:
        return text.decode()
    except UnicodeDecodeError:
        return None
