#include "scenarios/ensemble/twin_variants.hpp"

#include "engine/choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <sstream>

namespace bris {

const std::vector<std::string>& texts_of(TwinVariant) {
    static const std::vector<std::string> texts{"free", "inserted", "nudged", "analysis"};
    return texts;
}

std::vector<TwinVariant> variants_in(const std::string& list) {
    std::vector<TwinVariant> variants;
    if (list == "none") return variants;
    const auto& texts = texts_of(TwinVariant{});
    std::istringstream in(list);
    for (std::string text; std::getline(in, text, ',');) {
        require(std::ranges::count(texts, text) == 1,
                fmt::format("--variants: expected {}, found '{}'", fmt::join(texts, ", "), text));
        const auto variant = named<TwinVariant>(text);
        require(std::ranges::count(variants, variant) == 0,
                fmt::format("--variants: expected each variant once, found '{}' twice", text));
        variants.push_back(variant);
    }
    return variants;
}

} // namespace bris
