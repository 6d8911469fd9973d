#include "components/laws/table.hpp"

#include <algorithm>
#include <initializer_list>

namespace bris {

namespace {

template <class L>
LawTraits traits_of() {
    using Normal = typename L::Normal;
    static_assert(L::of_pairs.size() <= most_own_coefficients);
    static_assert(!L::has_reach || L::has_history,
                  "the spring history records which pairs have touched");
    return {.name = L::name,
            .summary = L::summary,
            .of_materials = L::of_materials,
            .of_pairs = L::of_pairs,
            .hertz = Normal::varying,
            .springs = L::has_history,
            .dashpots = L::has_dashpots,
            .rolling = L::has_rolling,
            .reaches = L::has_reach,
            .edges = L::has_edges,
            .wears = L::has_wear,
            .normal_stiffness = Normal::normal_name,
            .shear_stiffness = Normal::shear_name,
            .stiffness_unit = Normal::unit,
            .rows = Normal::rows,
            .elasticity = Normal::elasticity,
            .overlap_to_expect = Normal::overlap_to_expect,
            .couple_arm = L::RollingPart::arm_of,
            .own_row = L::own_row,
            .reach = L::reach,
            .potential = L::potential};
}

constexpr bool in_order(std::initializer_list<LawName> laws) {
    std::uint32_t k = 0;
    for (const LawName law : laws)
        if (static_cast<std::uint32_t>(law) != k++) return false;
    return true;
}

template <class... Ls>
std::array<LawTraits, sizeof...(Ls)> table_of(LawList<Ls...>) {
    static_assert(in_order({Ls::id...}), "the laws are listed in the order of LawName");
    return {traits_of<Ls>()...};
}

const auto& table() {
    static const auto all = table_of(Laws{});
    return all;
}

} // namespace

const LawTraits& traits(LawName law) { return table()[static_cast<std::size_t>(law)]; }

const std::vector<std::string>& texts_of(LawName) {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const LawTraits& t : table()) list.emplace_back(t.name);
        return list;
    }();
    return names;
}

double largest_reach(LawName law, const Materials& materials, double largest_radius) {
    const LawTraits& t = traits(law);
    double largest = 0;
    if (t.reaches)
        for (const OwnRow& row : materials.own_pairs)
            largest = std::max(largest, t.reach(row, largest_radius));
    return largest;
}

} // namespace bris
