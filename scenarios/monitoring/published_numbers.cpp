#include "scenarios/monitoring/published_numbers.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace bris {

namespace {

/// As the page and the documents name a message: its topic.
const char* topic_of(NumbersOf message) {
    return message == NumbersOf::test     ? "bris/state"
           : message == NumbersOf::timing ? "bris/timing"
                                          : "bris/sensor/ID";
}

} // namespace

std::string published_table() {
    nlohmann::json numbers = nlohmann::json::array(), curves = nlohmann::json::array();
    for (const PublishedNumber& n : published_numbers)
        numbers.push_back({{"topic", topic_of(n.message)},
                           {"name", n.name},
                           {"unit", n.unit},
                           {"meaning", n.meaning}});
    for (const PublishedCurve& c : published_curves) {
        nlohmann::json lines = nlohmann::json::array();
        for (const auto& line : c.lines)
            if (!line.name.empty())
                lines.push_back(
                    {{"name", line.name}, {"label", line.label}, {"half_width", line.half_width}});
        curves.push_back({{"topic", topic_of(c.message)},
                          {"title", c.title},
                          {"axis", c.axis},
                          {"factor", c.factor},
                          {"axis_factor", c.axis_factor},
                          {"over", c.over},
                          {"lines", lines}});
    }
    return nlohmann::json{{"numbers", numbers}, {"curves", curves}}.dump();
}

std::string published_table_for_documents() {
    std::string text = "| topic | number | unit | meaning |\n| --- | --- | --- | --- |\n";
    for (const PublishedNumber& n : published_numbers)
        text += fmt::format("| `{}` | `{}` | {} | {} |\n", topic_of(n.message), n.name, n.unit,
                            n.meaning);
    return text;
}

} // namespace bris
