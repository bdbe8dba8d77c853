"""Pictures of results, drawn as the command draws them, for notebooks."""

from __future__ import annotations

import base64
import html
import tempfile
from pathlib import Path
from typing import Callable, Dict, List, Sequence

from ._warning import Warning


def drawn(write: Callable[[str], object]) -> Dict[str, bytes]:
    """The pictures that `write` puts into a folder, by name without ending."""
    with tempfile.TemporaryDirectory(prefix="realgap-") as folder:
        write(folder)
        return {file.stem: file.read_bytes() for file in sorted(Path(folder).glob("*.png"))}


def one(draw: Callable[[str], object]) -> bytes:
    """The picture that `draw` puts into a file."""
    with tempfile.TemporaryDirectory(prefix="realgap-") as folder:
        path = Path(folder) / "picture.png"
        draw(str(path))
        return path.read_bytes()


def page(text: str, pictures: Sequence[bytes], warnings: Sequence[Warning] = ()) -> str:
    """HTML for a notebook: the text, the warnings, and the pictures below."""
    parts: List[str] = []
    if text:
        # Notebooks give `pre` a proportional font, which breaks tables of text.
        style = "font-family:monospace;font-size:0.8em;white-space:pre;overflow-x:auto"
        parts.append(f'<pre style="{style}">{html.escape(text)}</pre>')
    for warning in warnings:
        note = f"{warning.message} [{warning.code}]"
        parts.append(f"<p><b>warning:</b> {html.escape(note)}</p>")
    for picture in pictures:
        data = base64.b64encode(picture).decode("ascii")
        said = html.escape(text.split("\n", 1)[0] or "picture", quote=True)
        source = f"data:image/png;base64,{data}"
        parts.append(f'<img alt="{said}" src="{source}" style="max-width:100%;width:800px">')
    return "".join(parts)
