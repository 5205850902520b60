"""Buttons that put a text on the clipboard of whoever looks at the page: the browser does it, the server cannot."""

import json
from html import escape

STYLE = (
    "font:inherit;font-size:0.875em;padding:0.3em 0.8em;margin:0 0.5em 0.3em 0;border:0;border-radius:2px;"
    "background:#1971c2;color:white;cursor:pointer"
)
# Browsers let a page write to the clipboard only if it comes from this computer, or by https; else by the old way.
SCRIPT = (
    "const t={text},b=this,s=b.textContent,done=()=>{{b.textContent='copied';setTimeout(()=>b.textContent=s,1200)}};"
    "if(navigator.clipboard)navigator.clipboard.writeText(t).then(done);"
    "else{{const a=document.createElement('textarea');a.value=t;document.body.append(a);a.select();"
    "document.execCommand('copy');a.remove();done()}}"
)


def copy_buttons(texts: dict[str, str]) -> str:
    """The buttons as HTML.

    Args:
        texts: What is copied, by what stands on its button.
    """
    return "<div style='padding:0.3em 0.8em'>" + "".join(map(_button, texts, texts.values())) + "</div>"


def _button(label: str, text: str) -> str:
    script = escape(SCRIPT.format(text=json.dumps(text)), quote=True)
    return f'<button type="button" style="{STYLE}" onclick="{script}">{escape(label)}</button>'
