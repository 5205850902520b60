import math

from cockpit_browser import browser

from laticauda.cockpit.copying import copy_buttons

TEXTS = {"copy <this>": 'first "line" \\\n  --it\'s {one} & more', "copy that": f"{math.pi}"}


def test_a_button_puts_its_text_on_the_clipboard_as_it_is(tmp_path):
    (tmp_path / "page.html").write_text(f"<!doctype html><body>{copy_buttons(TEXTS)}</body>", encoding="utf-8")
    with browser() as found:
        page = found.new_context().new_page()
        # What the browser is asked to copy, in place of the clipboard, which a test must not overwrite.
        kept = "Object.defineProperty(navigator, 'clipboard', {value: {writeText: async t => {window.kept = t}}})"
        page.add_init_script(kept)
        page.goto((tmp_path / "page.html").as_uri())
        for label, text in TEXTS.items():
            page.get_by_role("button", name=label).click()
            assert page.evaluate("window.kept") == text


def test_where_the_browser_allows_no_clipboard_the_old_way_is_taken(tmp_path):
    (tmp_path / "page.html").write_text(f"<!doctype html><body>{copy_buttons(TEXTS)}</body>", encoding="utf-8")
    with browser() as found:
        page = found.new_context().new_page()
        page.add_init_script(
            "Object.defineProperty(navigator, 'clipboard', {value: undefined});"
            "document.execCommand = () => {window.kept = document.activeElement.value}"
        )
        page.goto((tmp_path / "page.html").as_uri())
        page.get_by_role("button", name="copy that").click()
        assert page.evaluate("window.kept") == TEXTS["copy that"]
        assert page.locator("textarea").count() == 0
