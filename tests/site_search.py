"""Search the built site as its own search does: `python tests/site_search.py WORD ...`, after `make docs`.

The site's search runs in a worker of the browser, over `search.json`; so it does here, without a
page around it. Without words, those are looked for that `test_site_search.py` looks for.
"""

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from cockpit_browser import browser

SITE = Path(__file__).parent.parent / "site"
SEARCH = """
async ([script, index, words]) => {
  const worker = new Worker(URL.createObjectURL(new Blob([script])));
  const ask = (message) => new Promise((answer) => {
    worker.onmessage = (event) => answer(event.data);
    worker.postMessage(message);
  });
  await ask({type: 0, data: index});
  const found = {};
  for (const word of words) {
    const answer = await ask({type: 2, data: {input: word}});
    found[word] = answer.data.items.map((item) => item.id);
  }
  return found;
}
"""


class Hit(NamedTuple):
    """A section that was found."""

    location: str
    title: str


def search(words: Iterable[str], site: Path = SITE) -> dict[str, list[Hit]]:
    """Return what the site's search shows for each word, first things first."""
    index: dict[str, Any] = json.loads((site / "search.json").read_text(encoding="utf-8"))
    (script,) = (site / "assets" / "javascripts" / "workers").glob("search.*.js")
    with browser() as started:
        page = started.new_page()
        numbers = page.evaluate(SEARCH, [script.read_text(encoding="utf-8"), index, list(words)])
    hits = [Hit(item["location"], item["title"]) for item in index["items"]]
    return {word: [hits[number] for number in found] for word, found in numbers.items()}


def main() -> None:
    from test_site_search import GUIDES

    for word, found in search(sys.argv[1:] or GUIDES).items():
        print(word)
        for hit in found[:5]:
            print(f"    {hit.location}  {hit.title}")


if __name__ == "__main__":
    main()
