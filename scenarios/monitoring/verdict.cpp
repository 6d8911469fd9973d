#include "scenarios/monitoring/verdict.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

constexpr std::array<const char*, verdicts> texts{
    "no train", "as the baseline", "quieter, or no train", "not enough data", "time unknown",
    "moved",    "another motion",  "another spectrum",     "quieter",         "louder",
    "drifts"};

constexpr Verdict verdict_at(std::size_t place) { return static_cast<Verdict>(place); }

} // namespace

const char* text_of(Verdict verdict) { return texts[static_cast<std::size_t>(verdict)]; }

bool is_change(Verdict verdict) { return verdict >= Verdict::another_motion; }

bool is_not_judged(Verdict verdict) {
    return !is_change(verdict) && verdict != Verdict::as_baseline;
}

void PassageTally::add(Verdict verdict, int count) {
    std::size_t& n = counts_[static_cast<std::size_t>(verdict)];
    n = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(n) + count);
}

std::size_t PassageTally::all() const {
    return changed() + not_judged_count() + count(Verdict::as_baseline);
}

std::size_t PassageTally::changed() const {
    std::size_t sum = 0;
    for (std::size_t k = 0; k < verdicts; ++k)
        if (is_change(verdict_at(k))) sum += counts_[k];
    return sum;
}

std::size_t PassageTally::not_judged_count() const {
    std::size_t sum = 0;
    for (std::size_t k = 0; k < verdicts; ++k)
        if (is_not_judged(verdict_at(k))) sum += counts_[k];
    return sum;
}

std::string PassageTally::not_judged() const {
    std::string reasons;
    const std::size_t sum = not_judged_count();
    for (std::size_t k = 0; k < verdicts; ++k)
        if (is_not_judged(verdict_at(k)) && counts_[k] > 0)
            reasons += fmt::format("{}{}{}", reasons.empty() ? "" : ", ", texts[k],
                                   counts_[k] == sum ? "" : fmt::format(" {}", counts_[k]));
    return reasons.empty() ? "" : fmt::format("{} not judged: {}", sum, reasons);
}

std::string PassageTally::sentence() const {
    std::string text =
        fmt::format("as the baseline in {} of {} passages", count(Verdict::as_baseline), all());
    for (std::size_t k = 0; k < verdicts; ++k)
        if (is_change(verdict_at(k)) && counts_[k] > 0)
            text += fmt::format(", {} in {}", texts[k], counts_[k]);
    const std::string others = not_judged();
    return others.empty() ? text : text + "; " + others;
}

} // namespace bris
