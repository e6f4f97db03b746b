"""The demo, with its small chessboard: every picture and file that the page names is there."""

import html.parser

import program


class Links(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.pictures = []

    def handle_starttag(self, tag, attributes):
        if tag == "img":
            self.pictures.append(dict(attributes)["src"])


class Demo(program.ProgramTest):
    def test_page_and_pictures(self):
        text = self.succeed("demo", "--small", "-o", "out/demo")
        self.assertIn("out/demo/index.html", text)
        page = (self.folder / "out/demo/index.html").read_text()
        links = Links()
        links.feed(page)
        self.assertEqual(len(links.pictures), len(set(links.pictures)))
        self.assertEqual(len(links.pictures), 3 * (12 + 3 + 1) + 4)
        for name in links.pictures:
            self.assertEqual(self.read_bytes(f"out/demo/{name}")[:4], b"\x89PNG", name)
        self.assertIn("simulated, not measured", page)
        self.assertIn("was not fetched", page)  # the shape that stands in for the dragon
        for name in ("chessboard", "stone", "embedded"):
            report = self.read_json(f"out/demo/{name}-errors.json")
            self.assertIn(f"{100 * report['relative_error']['mean']:.2f} %", page)

    def test_its_commands_reproduce_it(self):
        self.succeed("demo", "--small", "-o", "demo", "--quiet")
        lines = (self.folder / "demo/index.html").read_text().split("\n")
        commands = [line.removeprefix("<pre>").split() for line in lines
                    if line.removeprefix("<pre>").startswith("parian ")]
        self.assertEqual(len(commands), 1 + 3 * 12)
        before = {name: self.read_bytes(name)
                  for name in ("demo/chessboard.h5", "demo/stone-map.h5", "demo/stone-fit.json",
                               "demo/stone-errors.json", "demo/stone-errors.png",
                               "demo/stone-blend.kbm")}
        for command in commands:
            self.succeed(*command[1:], "--quiet")
        before.pop("demo/stone-fit.json")  # holds times
        for name, content in before.items():
            self.assertEqual(self.read_bytes(name), content, name)


if __name__ == "__main__":
    program.main()
