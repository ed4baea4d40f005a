"""Certificates for tests of encrypted links."""

import datetime
import ipaddress

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

ROLE = x509.ObjectIdentifier("1.3.6.1.4.1.50316.802.1")


def certificate(folder, name, address="127.0.0.1", role=None):
    """A self-signed certificate for ``address``; returns its file and its key's.

    ``role`` is the content of the Modbus role extension, DER.
    """
    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
    names = x509.SubjectAlternativeName([x509.IPAddress(ipaddress.ip_address(address))])
    begun = datetime.datetime.now(datetime.UTC) - datetime.timedelta(days=1)
    builder = (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(subject)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(begun)
        .not_valid_after(begun + datetime.timedelta(days=10))
        .add_extension(names, critical=False)
    )
    if role is not None:
        builder = builder.add_extension(x509.UnrecognizedExtension(ROLE, role), critical=False)
    files = folder / f"{name}.pem", folder / f"{name}.key"
    files[0].write_bytes(
        builder.sign(key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM)
    )
    files[1].write_bytes(
        key.private_bytes(
            serialization.Encoding.PEM,
            serialization.PrivateFormat.PKCS8,
            serialization.NoEncryption(),
        )
    )
    return files


def utf8(text):
    """The DER of a UTF8String."""
    return bytes([0x0C, len(text.encode())]) + text.encode()
