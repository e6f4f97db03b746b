// HTML pages of headings, paragraphs, tables and pictures: self-contained but for the pictures,
// which lie beside them.
#pragma once

#include <string>
#include <vector>

namespace parian {

std::string escape_html(const std::string& text);

struct HtmlFigure {
  std::string file;  // relative to the page
  std::string caption;
  bool pixelated = true;  // keep pixels sharp when the picture is enlarged
};

// Each returns a piece of HTML; texts are escaped.
std::string html_heading(const std::string& text);
std::string html_paragraph(const std::string& text);
std::string html_code(const std::vector<std::string>& lines);
// The first row is the head, the first column names the rows.
std::string html_table(const std::vector<std::vector<std::string>>& rows);
std::string html_figures(const std::vector<HtmlFigure>& figures, int columns);
// Pictures in rows and columns, with a name above each column and before each row.
std::string html_picture_table(const std::vector<std::string>& columns,
                               const std::vector<std::string>& rows,
                               const std::vector<std::vector<HtmlFigure>>& pictures);

// The page around them.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace parian
