#include "app/report/html.h"

#include <fmt/format.h>

namespace parian {
namespace {

// A neutral grey ground, light or dark as the reader's system is, so that colours are judged well.
constexpr const char* style = R"(
:root { color-scheme: light dark; --ground: #e9e9e9; --card: #f7f7f7; --text: #1c1c1c;
  --soft: #5c5c5c; --line: #cfcfcf; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #2b2b2b; --card: #363636; --text: #ececec; --soft: #ababab; --line: #4d4d4d; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--text);
  font: 16px/1.5 system-ui, "Segoe UI", "Helvetica Neue", sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 2.5rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; font-weight: 600; margin: 0 0 .5rem; }
h2 { font-size: 1.3rem; font-weight: 600; margin: 2.5rem 0 .5rem; padding-top: 1rem;
  border-top: 1px solid var(--line); }
p { max-width: 46rem; }
figure { margin: 0; }
img { display: block; width: 100%; height: auto; border-radius: 3px; }
img.sharp { image-rendering: pixelated; }
figcaption { color: var(--soft); font-size: .85rem; margin-top: .3rem; }
.figures { display: grid; gap: 1.25rem; margin: 1.25rem 0; }
@media (max-width: 700px) { .figures { grid-template-columns: 1fr !important; } }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: 1.25rem 0; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .9rem .3rem 0; text-align: right; border-bottom: 1px solid var(--line); }
th { font-weight: 600; } th:first-child { text-align: left; font-weight: 400; }
table.pictures { width: 100%; table-layout: fixed; }
table.pictures th, table.pictures td { border: 0; padding: .25rem; text-align: center; }
table.pictures th:first-child { width: 5.5rem; text-align: left; color: var(--soft); }
pre { background: var(--card); border: 1px solid var(--line); border-radius: 4px;
  padding: .8rem 1rem; overflow-x: auto; font-size: .85rem; }
)";

std::string image_tag(const HtmlFigure& figure) {
  return fmt::format("<img{} src=\"{}\" alt=\"{}\">", figure.pixelated ? " class=\"sharp\"" : "",
                     escape_html(figure.file), escape_html(figure.caption));
}

}  // namespace

std::string escape_html(const std::string& text) {
  std::string escaped;
  for (char letter : text) {
    switch (letter) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += letter;
    }
  }
  return escaped;
}

std::string html_heading(const std::string& text) {
  return "<h2>" + escape_html(text) + "</h2>\n";
}

std::string html_paragraph(const std::string& text) {
  return "<p>" + escape_html(text) + "</p>\n";
}

std::string html_code(const std::vector<std::string>& lines) {
  std::string text = "<pre>";
  for (const std::string& line : lines) text += escape_html(line) + "\n";
  return text + "</pre>\n";
}

std::string html_table(const std::vector<std::vector<std::string>>& rows) {
  std::string text = "<div class=\"scroll\"><table>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += "<tr>";
    for (std::size_t k = 0; k < rows[i].size(); ++k) {
      const char* tag = i == 0 || k == 0 ? "th" : "td";
      text += fmt::format("<{0}>{1}</{0}>", tag, escape_html(rows[i][k]));
    }
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string html_figures(const std::vector<HtmlFigure>& figures, int columns) {
  std::string text = fmt::format(
      "<div class=\"figures\" style=\"grid-template-columns: repeat({}, 1fr)\">\n", columns);
  for (const HtmlFigure& figure : figures)
    text += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", image_tag(figure),
                        escape_html(figure.caption));
  return text + "</div>\n";
}

std::string html_picture_table(const std::vector<std::string>& columns,
                               const std::vector<std::string>& rows,
                               const std::vector<std::vector<HtmlFigure>>& pictures) {
  std::string text = "<table class=\"pictures\">\n<tr><th></th>";
  for (const std::string& column : columns) text += "<th>" + escape_html(column) + "</th>";
  text += "</tr>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += "<tr><th>" + escape_html(rows[i]) + "</th>";
    for (const HtmlFigure& picture : pictures[i]) text += "<td>" + image_tag(picture) + "</td>";
    text += "</tr>\n";
  }
  return text + "</table>\n";
}

std::string html_page(const std::string& title, const std::string& body) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n{2}"
      "</main>\n</body>\n</html>\n",
      escape_html(title), style, body);
}

}  // namespace parian
