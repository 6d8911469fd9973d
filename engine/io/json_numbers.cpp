#include "engine/io/json_numbers.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"

#define BOOST_BIND_GLOBAL_PLACEHOLDERS // what property_tree itself includes
#include <fmt/format.h>

#include <boost/property_tree/json_parser.hpp>
#include <sstream>

namespace bris {

std::string beginning_of(const std::string& text) {
    return text.size() > 40 ? text.substr(0, 40) + "..." : text;
}

std::map<std::string, double> json_numbers(const std::string& text) {
    // before it is parsed: what is nested deeply would be parsed deeply
    require(text.find('[') == std::string::npos && text.find('{') == text.rfind('{'),
            fmt::format("expected a flat object of JSON, found \"{}\"", beginning_of(text)));
    boost::property_tree::ptree tree;
    std::istringstream stream(text);
    try {
        boost::property_tree::read_json(stream, tree);
    } catch (const boost::property_tree::json_parser_error& e) {
        throw InputError(fmt::format("expected an object of JSON, found \"{}\" ({})",
                                     beginning_of(text), e.message()));
    }
    std::map<std::string, double> numbers;
    for (const auto& [name, value] : tree) {
        if (value.empty() && value.data() == "null") continue;
        const auto number = value.data().empty() ? std::nullopt : number_of(value.data());
        require(number.has_value(), fmt::format("{}: expected a number, found \"{}\"", name,
                                                beginning_of(value.data())));
        require(numbers.emplace(name, *number).second,
                fmt::format("{}: expected once, found twice", name));
    }
    return numbers;
}

} // namespace bris
