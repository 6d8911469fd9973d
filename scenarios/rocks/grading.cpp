#include "scenarios/rocks/grading.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/random.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace bris {
namespace {

/// Draws clump indices such that each appears equally often: shuffled decks, one after another.
class Deck {
public:
    Deck(std::size_t clumps, std::uint64_t seed) : random_(seed, 11), cards_(clumps) {
        std::iota(cards_.begin(), cards_.end(), std::size_t{0});
        next_ = clumps;
    }
    std::size_t draw() {
        if (next_ == cards_.size()) {
            shuffle(cards_, random_);
            next_ = 0;
        }
        return cards_[next_++];
    }
    template <class Values>
    static void shuffle(Values& values, Random& random) {
        for (std::size_t k = values.size(); k > 1; --k)
            std::swap(values[k - 1], values[random.bits() % k]);
    }

private:
    Random random_;
    std::vector<std::size_t> cards_;
    std::size_t next_;
};

double cubed(double x) { return x * x * x; }

/// Volume of a clump at sieve size 1.
double unit_volume(const Clump& clump) { return clump.volume / cubed(clump.sieve); }

/// Divides the total volume `total` into rocks along the curve, from coarse to fine; stops after
/// `most` rocks.
std::vector<RockChoice> lay_out(const Grading& grading, std::span<const Clump> clumps, double total,
                                std::uint64_t seed, double truncated, std::size_t most) {
    Deck deck(clumps.size(), seed);
    std::vector<RockChoice> rocks;
    const auto size_at = [&](double laid) {
        return grading.size_at(1 - (1 - truncated) * laid / total);
    };
    for (double laid = 0; rocks.size() < most;) {
        if (interrupted()) throw Interrupted("interrupted; nothing was written");
        const std::size_t clump = deck.draw();
        const double volume = unit_volume(clumps[clump]);
        // the middle of the rock depends on its size, which falls along the curve: bisection
        double low = 0, high = size_at(laid);
        for (int round = 0; round < 60; ++round) {
            const double size = 0.5 * (low + high);
            const double middle = laid + 0.5 * volume * cubed(size);
            (middle < total && size_at(middle) > size ? low : high) = size;
        }
        const double middle = laid + 0.5 * volume * cubed(low);
        // less than half of this rock would fit: the remainder is below half a rock of finest size
        if (middle >= total * (1 - 1e-12) || total - laid < 0.5 * volume * cubed(size_at(total)))
            break;
        rocks.push_back({clump, low});
        laid += volume * cubed(low);
    }
    return rocks;
}

RockSample finished(std::vector<RockChoice> rocks, std::span<const Clump> clumps,
                    std::uint64_t seed, double smallest, double truncated) {
    RockSample sample{.rocks = std::move(rocks),
                      .solid_volume = 0,
                      .smallest_size = smallest,
                      .truncated_fraction = truncated};
    for (const RockChoice& rock : sample.rocks)
        sample.solid_volume += unit_volume(clumps[rock.clump]) * cubed(rock.sieve);
    Random random(seed, 13);
    Deck::shuffle(sample.rocks, random);
    return sample;
}

/// Size at which the grading is truncated, and the mass fraction below it.
std::pair<double, double> cut(const Grading& grading, std::span<const Clump> clumps,
                              double smallest) {
    require(!clumps.empty(), "grading: expected at least one clump, found none");
    if (smallest == 0) smallest = grading.sieves.back().size;
    const double truncated = grading.passing(smallest);
    require(smallest > 0 && truncated < 1,
            fmt::format("grading {}: smallest size: expected below {} m, found {} m", grading.name,
                        grading.size_at(1), smallest));
    return {smallest, truncated};
}

} // namespace

double Grading::passing(double size) const {
    if (size >= sieves.front().size) return 1;
    Sieve coarse = sieves.front();
    const double end = 0.5 * sieves.back().size;
    for (std::size_t k = 1; k <= sieves.size(); ++k) {
        const Sieve fine = k < sieves.size() ? sieves[k] : Sieve{end, 0, 0};
        if (size >= fine.size) {
            const double t = std::log(size / fine.size) / std::log(coarse.size / fine.size);
            return fine.middle() + t * (coarse.middle() - fine.middle());
        }
        coarse = fine;
    }
    return 0;
}

double Grading::size_at(double share) const {
    Sieve coarse = sieves.front();
    const double end = 0.5 * sieves.back().size;
    for (std::size_t k = 1; k <= sieves.size(); ++k) {
        const Sieve fine = k < sieves.size() ? sieves[k] : Sieve{end, 0, 0};
        const double drop = coarse.middle() - fine.middle();
        if (share >= fine.middle() && drop > 0) {
            const double t = std::clamp((share - fine.middle()) / drop, 0.0, 1.0);
            return fine.size * std::pow(coarse.size / fine.size, t);
        }
        coarse = fine;
    }
    return end;
}

double expected_rocks(const Grading& grading, std::span<const Clump> clumps, double solid_volume,
                      double smallest_size) {
    const auto [smallest, truncated] = cut(grading, clumps, smallest_size);
    double volume = 0; // of a rock of sieve size 1, mean over the clumps
    for (const Clump& clump : clumps)
        volume += unit_volume(clump) / static_cast<double>(clumps.size());
    // where the passing mass is linear in the logarithm of the size d, the integral of its
    // increment over d^3 is the difference of d^-3 times a third of the slope
    double per_volume = 0;
    for (std::size_t k = 1; k <= grading.sieves.size(); ++k) {
        const double coarse = grading.sieves[k - 1].size;
        const double fine =
            std::max(smallest, k < grading.sieves.size() ? grading.sieves[k].size : 0.5 * coarse);
        if (fine >= coarse) break;
        const double slope =
            (grading.passing(coarse) - grading.passing(fine)) / std::log(coarse / fine);
        per_volume += slope / 3 * (1 / cubed(fine) - 1 / cubed(coarse)) / volume;
    }
    return solid_volume * per_volume / (1 - truncated);
}

std::pair<double, double> cut_for(const Grading& grading, std::span<const Clump> clumps,
                                  double solid_volume, double most) {
    std::pair<double, double> found{0, 0};
    for (auto sieve = grading.sieves.rbegin(); sieve != grading.sieves.rend(); ++sieve) {
        if (grading.passing(sieve->size) >= 1) break;
        found = {sieve->size, expected_rocks(grading, clumps, solid_volume, sieve->size)};
        if (found.second <= most) break;
    }
    return found;
}

void require_countable(const Grading& grading, std::span<const Clump> clumps, double solid_volume,
                       double smallest_size, const std::string& option) {
    const double found = expected_rocks(grading, clumps, solid_volume, smallest_size);
    if (found <= most_rocks) return;
    const auto [sieve, rocks] = cut_for(grading, clumps, solid_volume);
    throw InputError(fmt::format("{}: expected at most {:g} rocks, found {:.3g} of grading {}; cut "
                                 "at its sieve of {:g} mm there are {:.3g}",
                                 option, most_rocks, found, grading.name, 1e3 * sieve, rocks));
}

RockSample sample_rocks(const Grading& grading, std::span<const Clump> clumps, std::size_t count,
                        std::uint64_t seed, double smallest_size) {
    const auto [smallest, truncated] = cut(grading, clumps, smallest_size);
    require(count > 0, "grading: expected at least one rock, found 0");
    // the number of rocks grows with their total volume: bisection for the volume
    const auto rocks_of = [&](double total) {
        return lay_out(grading, clumps, total, seed, truncated, count + 1);
    };
    double low = 0, high = static_cast<double>(count) * cubed(smallest);
    while (rocks_of(high).size() < count) low = high, high *= 2;
    std::vector<RockChoice> rocks = rocks_of(high);
    for (int round = 0; round < 200 && rocks.size() != count; ++round) {
        const double middle = 0.5 * (low + high);
        rocks = rocks_of(middle);
        (rocks.size() < count ? low : high) = middle;
    }
    require(rocks.size() == count,
            fmt::format("grading {}: expected {} rocks, found no solid volume that gives this "
                        "count, only {}; choose a slightly different count",
                        grading.name, count, rocks.size()));
    return finished(std::move(rocks), clumps, seed, smallest, truncated);
}

SieveReport sieve_back(std::span<const RockChoice> rocks, std::span<const Clump> clumps,
                       const Grading& grading, double truncated_fraction) {
    require(!rocks.empty(), "sieving: expected at least one rock, found none");
    std::vector<double> passing(grading.sieves.size(), 0.0);
    double total = 0;
    for (const RockChoice& rock : rocks) {
        require(rock.clump < clumps.size(),
                "sieving: a rock refers to a clump that does not exist");
        const double volume = unit_volume(clumps[rock.clump]) * cubed(rock.sieve);
        total += volume;
        for (std::size_t k = 0; k < passing.size(); ++k)
            if (rock.sieve < grading.sieves[k].size * (1 + 1e-12)) passing[k] += volume;
    }
    SieveReport report;
    for (std::size_t k = 0; k < passing.size(); ++k) {
        const Sieve& sieve = grading.sieves[k];
        const double share = passing[k] / total;
        const double whole = truncated_fraction + (1 - truncated_fraction) * share;
        // a specimen truncated above this sieve cannot be judged on it: the sizes of its truncated
        // fraction are unknown
        const bool assessment = share > 0 || truncated_fraction == 0;
        constexpr double slack = 1e-3;
        const bool within =
            !assessment || (whole >= sieve.lower - slack && whole <= sieve.upper + slack);
        report.sieves.push_back({sieve.size, share, whole, sieve.lower, sieve.upper, within});
        report.within = report.within && within;
    }
    return report;
}

std::string sentence_of(const RockSample& sample, const SieveReport& report) {
    std::string text =
        fmt::format("{} rocks, {:.6g} m3 of solids; truncated below {:.2f} mm: {:.2f} % "
                    "of the mass\n",
                    sample.rocks.size(), sample.solid_volume, 1e3 * sample.smallest_size,
                    100 * sample.truncated_fraction);
    text += "sieve_mm  passing_%  with_tail_%  band_%\n";
    for (const SieveResult& sieve : report.sieves)
        text += fmt::format("{:8.2f}  {:9.2f}  {:11.2f}  {:.0f}-{:.0f} {}\n", 1e3 * sieve.size,
                            100 * sieve.passing, 100 * sieve.with_tail, 100 * sieve.lower,
                            100 * sieve.upper, sieve.within ? "" : "OUTSIDE");
    return text;
}

} // namespace bris
