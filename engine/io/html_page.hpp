#pragma once

#include "engine/io/plot.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// One HTML page that needs no other file: text, tables and plots (inline SVG), without scripts,
/// for light and dark screens and for phones. Texts are escaped.
class HtmlPage {
public:
    explicit HtmlPage(const std::string& title);
    void heading(const std::string& text);
    void paragraph(const std::string& text);
    /// A box of a colour: "good", "bad" or "unknown", with a word in bold.
    void verdict(const std::string& kind, const std::string& word, const std::string& text);
    /// Cells by row; the first row is the head. `kinds`: of the rows below it, as in verdict, or
    /// empty.
    void table(const std::vector<std::vector<std::string>>& rows,
               const std::vector<std::string>& kinds = {});
    void plot(const Plot& plot);
    /// Opens and closes a part that a reader may fold away.
    void begin_details(const std::string& summary);
    void end_details();

    std::string text() const;
    /// Writes the page, whole or not at all. Throws OutputError.
    void write(const std::filesystem::path& path) const;

private:
    std::string title_, body_;
};

} // namespace bris
