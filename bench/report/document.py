"""A report as HTML in one file and as Markdown, with every table as CSV and every plot as SVG."""
import base64
import csv
import html
import io
import pathlib
import statistics

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 75rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
table { border-collapse: collapse; font-size: 14px; margin: .5rem 0; }
.scroll { overflow-x: auto; }
th { text-align: right; border-bottom: 2px solid #888; padding: .15rem .6rem; vertical-align: bottom; }
td { text-align: right; border-bottom: 1px solid #ddd; padding: .15rem .6rem; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
tr:hover td { background: #f3f6fa; }
figure { margin: 1rem 0; } figcaption, .note { color: #555; font-size: 14px; }
svg, img { max-width: 100%; height: auto; }
.row { display: flex; flex-wrap: wrap; gap: 1rem; } .row figure { flex: 1 1 18rem; margin: 0; max-width: 26rem; }
.missed { border-left: 4px solid #c33; padding: .5rem 1rem; background: #fdf3f3; }
.met { border-left: 4px solid #393; padding: .5rem 1rem; background: #f3fbf3; }
nav { columns: 3; font-size: 14px; }
"""


def short(value):
    """A cell: at most three digits of a number."""
    if value is None or value != value:
        return "-"
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(value, float):
        if value == 0 or 1e-3 <= abs(value) < 1e4:
            return f"{value:.3g}" if abs(value) < 1000 else f"{value:,.0f}"
        return f"{value:.1e}"
    return str(value)


def spread(values, form="{:.3g}"):
    """Median [smallest, largest]."""
    values = [value for value in values if value is not None]
    if not values:
        return "-"
    if len(values) == 1:
        return form.format(values[0])
    return "{} [{}, {}]".format(*(form.format(x) for x in (statistics.median(values), min(values), max(values))))


class Document:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        for name in ("tables", "figures"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        self.parts = []  # (html, markdown)
        self.contents = []
        self.goals = []  # (met, sentence)

    def goal(self, met, sentence):
        self.goals.append((bool(met), sentence))

    def heading(self, text):
        anchor = f"part{len(self.contents)}"
        self.contents.append((anchor, text))
        self.parts.append((f'<h2 id="{anchor}">{html.escape(text)}</h2>', f"## {text}"))

    def text(self, words):
        self.parts.append((f"<p>{html.escape(words)}</p>", words))

    def table(self, name, columns, rows, note=""):
        """columns: (title, key or function of a row).  Rows are dictionaries; their values are all in the CSV."""
        if not rows:
            return self.text(f"Not measured: {name}.")
        cells = [[short(get(row) if callable(get) else row.get(get)) for _, get in columns] for row in rows]
        titles = [title for title, _ in columns]
        head = "".join(f"<th>{html.escape(title)}</th>" for title in titles)
        body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in line) + "</tr>" for line in cells)
        link = f"tables/{name}.csv"
        page = f'<div class="scroll"><table><tr>{head}</tr>{body}</table></div>'
        page += f'<p class="note">{html.escape(note)} Numbers: {link}</p>'
        plain = ["| " + " | ".join(titles) + " |", "|---" + "|--:" * (len(titles) - 1) + "|"]
        plain += ["| " + " | ".join(cell.replace("|", "/") for cell in line) + " |" for line in cells]
        self.parts.append((page, "\n".join(plain) + f"\n\n{note} Numbers: [{link}]({link})".rstrip()))
        self.numbers(name, rows)
        return None

    def numbers(self, name, rows):
        """The CSV file of a table: all values of the rows, without the texts made of them."""
        keys = list(dict.fromkeys(key for row in rows for key in row if key != "row" and not key.endswith("_text")))
        with open(self.folder / "tables" / f"{name}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, keys, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows({key: f"{value:.7g}" if isinstance(value, float) else value for key, value in row.items()}
                             for row in rows)

    def plot(self, name, caption, draw, size=(9, 4.2)):
        """draw(figure) fills a matplotlib figure."""
        try:
            import matplotlib
        except ImportError:
            return self.text(f"No plot {name}: matplotlib is missing. {caption}")
        matplotlib.use("Agg")
        matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": name, "axes.grid": True,
                                    "grid.alpha": 0.3, "axes.spines.top": False, "axes.spines.right": False})
        import matplotlib.pyplot as pyplot
        figure = pyplot.figure(figsize=size, layout="constrained")
        draw(figure)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None})
        pyplot.close(figure)
        text = stream.getvalue()
        (self.folder / "figures" / f"{name}.svg").write_text(text)
        # Names inside of an SVG must differ from those of the others on the page.
        inside = text[text.index("<svg"):].replace('id="', f'id="{name}-').replace('"#', f'"#{name}-')
        inside = inside.replace("url(#", f"url(#{name}-")
        self.parts.append((f"<figure>{inside}<figcaption>{html.escape(caption)}</figcaption></figure>",
                           f"![{name}](figures/{name}.svg)\n\n{caption}"))
        return None

    def pictures(self, images):
        """Side by side: (name, PNG bytes, caption)."""
        page, plain = [], []
        for name, png, caption in images:
            (self.folder / "figures" / f"{name}.png").write_bytes(png)
            data = base64.b64encode(png).decode()
            page.append(f'<figure><img alt="{name}" src="data:image/png;base64,{data}">'
                        f"<figcaption>{html.escape(caption)}</figcaption></figure>")
            plain.append(f"![{name}](figures/{name}.png)\n\n{caption}")
        self.parts.append((f'<div class="row">{"".join(page)}</div>', "\n\n".join(plain)))

    def save(self, title, opening):
        """opening: paragraphs after the goals."""
        missed = [sentence for met, sentence in self.goals if not met]
        reached = [sentence for met, sentence in self.goals if met]
        kind, first = ("missed", "Falls short: " + " ".join(missed)) if missed else ("met", "No goal is missed.")
        others = [f"Goals that are met ({len(reached)} of {len(self.goals)}): " + " ".join(reached)] if reached else []
        links = "".join(f'<a href="#{anchor}">{html.escape(text)}</a><br>' for anchor, text in self.contents)
        page = [f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{html.escape(title)}</title>',
                f"<style>{STYLE}</style><h1>{html.escape(title)}</h1>", f'<p class="{kind}">{html.escape(first)}</p>']
        page += [f"<p>{html.escape(words)}</p>" for words in others + opening]
        page += [f"<nav>{links}</nav>"] + [part for part, _ in self.parts]
        (self.folder / "report.html").write_text("\n".join(page) + "\n")
        (self.folder / "report.md").write_text(
            "\n\n".join([f"# {title}", first, *others, *opening] + [part for _, part in self.parts]) + "\n")
