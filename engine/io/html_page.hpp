#pragma once

#include "engine/io/plot.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bris {

/// One HTML page that needs no other file: text, tables, plots (inline SVG) and pictures, without
/// scripts, for light and dark screens and for phones. Texts are escaped.
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
    /// A picture with its caption, from the bytes of a PNG.
    void picture(const std::string& caption, std::string_view png);
    /// What a reader types, as it is.
    void command(const std::string& text);
    /// Links to files, named as they are seen from the page's folder, with a text behind each.
    void links(const std::vector<std::pair<std::string, std::string>>& files);
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
