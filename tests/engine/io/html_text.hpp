#pragma once

#include <cstddef>
#include <regex>
#include <string>
#include <vector>

namespace bris::testing {

/// Whether every element that is opened is closed, in order.
inline bool is_balanced(const std::string& html) {
    static const std::regex tag("<(/?)([a-zA-Z0-9]+)([^>]*)>");
    std::vector<std::string> open;
    for (auto at = std::sregex_iterator(html.begin(), html.end(), tag);
         at != std::sregex_iterator(); ++at) {
        const std::string name = at->str(2), rest = at->str(3);
        if (name == "meta" || name == "br" || name == "img" || rest.ends_with('/')) continue;
        if (at->str(1).empty())
            open.push_back(name);
        else if (open.empty() || open.back() != name)
            return false;
        else
            open.pop_back();
    }
    return open.empty();
}

inline std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
}

/// A page whose pictures are left out, for regular expressions cannot read megabytes.
inline std::string without_pictures(std::string html) {
    const std::string begin = "data:image/png;base64,";
    for (auto at = html.find(begin); at != std::string::npos; at = html.find(begin, at)) {
        at += begin.size();
        html.erase(at, html.find('"', at) - at);
    }
    return html;
}

/// What in a page would be fetched or run when it is opened; empty: nothing. Links, which a reader
/// follows, lead to files beside it.
inline std::vector<std::string> fetched_by(std::string html) {
    std::vector<std::string> found;
    for (const char* what :
         {"<script", "<link", "<iframe", "<object", "@import", "url(", "http:", "https:", "srcset"})
        if (html.find(what) != std::string::npos) found.emplace_back(what);
    static const std::regex address("(src|href)=\"([^\"]*)\"");
    html = without_pictures(html);
    for (auto at = std::sregex_iterator(html.begin(), html.end(), address);
         at != std::sregex_iterator(); ++at)
        if (at->str(1) == "src" ? at->str(2) != "data:image/png;base64,"
                                : !at->str(2).starts_with("./"))
            found.push_back(at->str());
    return found;
}

} // namespace bris::testing
