#include "scenarios/records/stated_rate.hpp"

#include "engine/io/csv.hpp"

#include <cctype>

namespace bris {

double rate_stated_in(const std::vector<std::string>& lines) {
    double rate = 0;
    for (std::string line : lines) {
        for (char& c : line) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        const auto word = line.find("rate"), hertz = line.find("hz", word);
        if (word == std::string::npos || hertz == std::string::npos) continue;
        const auto from = line.find_first_of("0123456789", word);
        if (from == std::string::npos || from > hertz) continue;
        const bool kilo = line[hertz - 1] == 'k';
        const auto number = number_of(trimmed(line.substr(from, hertz - from - (kilo ? 1 : 0))));
        if (!number || !(*number > 0)) continue;
        const double found = *number * (kilo ? 1e3 : 1);
        if (rate != 0 && rate != found) return 0;
        rate = found;
    }
    return rate;
}

} // namespace bris
