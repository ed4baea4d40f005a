"""Files that a test writes into a folder of its own."""


def write_files(folder, texts):
    """Write texts by their paths in the folder."""
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
