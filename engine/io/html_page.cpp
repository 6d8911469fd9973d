#include "engine/io/html_page.hpp"

#include "engine/io/base64.hpp"
#include "engine/io/svg_plot.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>

namespace bris {

namespace {

constexpr std::string_view style =
    "body{margin:0 auto;padding:1rem;max-width:60rem;font:16px/1.5 system-ui,sans-serif;"
    "color:var(--text);background:var(--page);overflow-wrap:break-word}"
    "h1{font-size:1.5rem;line-height:1.2}h2{font-size:1.2rem;margin-top:2rem}"
    ".scroll{overflow-x:auto}table{border-collapse:collapse;font-size:.9rem}"
    "th,td{padding:.25rem .6rem;text-align:left;vertical-align:top;border-bottom:1px solid "
    "var(--grid)}"
    ".long{overflow-wrap:anywhere}.long:last-child{min-width:14rem}td:not(.long){white-space:"
    "nowrap}"
    ".box{padding:.8rem 1rem;border-left:.5rem solid;border-radius:.25rem;margin:1rem 0}"
    ".box b{font-size:1.15rem}.good{border-color:#009e73;background:var(--good)}"
    ".bad{border-color:#d55e00;background:var(--bad)}"
    ".unknown{border-color:#8a8a8a;background:var(--unknown)}"
    "figure{margin:1rem 0}figcaption{font-size:.9rem}"
    "img{max-width:100%;height:auto;background:#fff;border-radius:.25rem}"
    "pre{padding:.6rem .8rem;white-space:pre-wrap;background:var(--unknown)}"
    "details{margin:.6rem 0}summary{cursor:pointer;font-weight:600}"
    ":root{color-scheme:light dark;--page:#fff;--good:#e2f5ee;--bad:#fdebdf;--unknown:#efefef}"
    "@media(prefers-color-scheme:dark){:root{--page:#161616;--good:#10382d;--bad:#47260f;"
    "--unknown:#2b2b2b}}";

/// Letters of a cell that stay on one line, as a number with its unit.
constexpr std::size_t longest_unbroken = 20;

/// A number of four bytes in a PNG; 0 where the file has ended.
std::uint32_t number_at(std::string_view png, std::size_t at) {
    std::uint32_t number = 0;
    for (const char c : png.substr(std::min(at, png.size()), 4))
        number = number << 8 | static_cast<unsigned char>(c);
    return number;
}

/// The address of a file beside the page.
std::string address(std::string_view name) {
    std::string out;
    for (const char c : name)
        out += std::isalnum(static_cast<unsigned char>(c)) != 0 || std::strchr("/._-", c) != nullptr
                   ? std::string(1, c)
                   : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    return "./" + out; // a name may begin as an address elsewhere does
}

} // namespace

HtmlPage::HtmlPage(const std::string& title) : title_(escaped_for_html(title)) {
    body_ = fmt::format("<h1>{}</h1>\n", title_);
}

void HtmlPage::heading(const std::string& text) {
    body_ += fmt::format("<h2>{}</h2>\n", escaped_for_html(text));
}

void HtmlPage::paragraph(const std::string& text) {
    body_ += fmt::format("<p>{}</p>\n", escaped_for_html(text));
}

void HtmlPage::verdict(const std::string& kind, const std::string& word, const std::string& text) {
    body_ += fmt::format("<div class=\"box {}\"><b>{}</b><br>{}</div>\n", escaped_for_html(kind),
                         escaped_for_html(word), escaped_for_html(text));
}

void HtmlPage::table(const std::vector<std::vector<std::string>>& rows,
                     const std::vector<std::string>& kinds) {
    body_ += "<div class=\"scroll\"><table>\n";
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const bool has_kind = r > 0 && r - 1 < kinds.size() && !kinds[r - 1].empty();
        body_ += has_kind ? fmt::format("<tr class=\"{}\">", escaped_for_html(kinds[r - 1]))
                          : std::string("<tr>");
        const char* const cell = r == 0 ? "th" : "td";
        for (const std::string& text : rows[r])
            body_ += fmt::format("<{}{}>{}</{}>", cell,
                                 text.size() > longest_unbroken ? " class=\"long\"" : "",
                                 escaped_for_html(text), cell);
        body_ += "</tr>\n";
    }
    body_ += "</table></div>\n";
}

void HtmlPage::plot(const Plot& plot) { body_ += svg_plot(plot); }

void HtmlPage::picture(const std::string& caption, std::string_view png) {
    constexpr std::size_t width = 16, height = 20; // where a PNG states its size
    const std::string text = escaped_for_html(caption);
    body_ += fmt::format("<figure><img alt=\"{}\" width=\"{}\" height=\"{}\" "
                         "src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
                         text, number_at(png, width), number_at(png, height), to_base64(png), text);
}

void HtmlPage::command(const std::string& text) {
    body_ += fmt::format("<pre>{}</pre>\n", escaped_for_html(text));
}

void HtmlPage::links(const std::vector<std::pair<std::string, std::string>>& files) {
    body_ += "<ul>\n";
    for (const auto& [name, text] : files)
        body_ += fmt::format("<li><a href=\"{}\">{}</a> {}</li>\n", address(name),
                             escaped_for_html(name), escaped_for_html(text));
    body_ += "</ul>\n";
}

void HtmlPage::begin_details(const std::string& summary) {
    body_ += fmt::format("<details><summary>{}</summary>\n", escaped_for_html(summary));
}

void HtmlPage::end_details() { body_ += "</details>\n"; }

std::string HtmlPage::text() const {
    return fmt::format("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
                       "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
                       "<title>{}</title>\n<style>{}{}</style></head>\n<body>\n{}</body></html>\n",
                       title_, svg_plot_style, style, body_);
}

void HtmlPage::write(const std::filesystem::path& path) const { write_whole(path, text()); }

} // namespace bris
