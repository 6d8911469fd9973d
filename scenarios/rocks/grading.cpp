#include "scenarios/rocks/grading.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/csv.hpp"
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

void check_rows(const std::filesystem::path& path, const Grading& grading,
                const std::vector<int>& lines) {
    const auto refuse = [&](std::size_t k, const std::string& what) {
        throw InputError(fmt::format("{}:{}: {}", path.string(), lines[k], what));
    };
    constexpr double least_coarse = 1e-4, most_coarse = 2; // m, of gradings of grains
    constexpr double widest = 1e4;                         // ratio of sieves
    for (std::size_t k = 0; k < grading.sieves.size(); ++k) {
        const Sieve& sieve = grading.sieves[k];
        if (!(sieve.size > 0 && std::isfinite(sieve.size)))
            refuse(k, "sieve: expected a positive size");
        const double coarsest = grading.sieves.front().size;
        if (k == 0 && !(coarsest >= least_coarse && coarsest <= most_coarse))
            refuse(k,
                   fmt::format("sieve_mm: expected {:g} to {:g} mm for the coarsest sieve, found "
                               "{:.4g} mm: is it in another unit?",
                               1e3 * least_coarse, 1e3 * most_coarse, 1e3 * coarsest));
        if (sieve.size * widest < coarsest)
            refuse(k, fmt::format("sieve_mm: expected at least 1/{:g} of the coarsest sieve, found "
                                  "{:.4g} mm",
                                  widest, 1e3 * sieve.size));
        if (std::isnan(sieve.lower) != std::isnan(sieve.upper))
            refuse(k, "limits: expected two numbers, or - in both columns, found one of each");
        if (!(sieve.lower >= 0 && sieve.upper <= 1 && sieve.lower <= sieve.upper))
            refuse(k, fmt::format("limits: expected 0 <= lower <= upper <= 100, found {} and {}",
                                  100 * sieve.lower, 100 * sieve.upper));
        if (k == 0) continue;
        const Sieve& coarser = grading.sieves[k - 1];
        if (sieve.size >= coarser.size)
            refuse(k, "sieve: expected sizes that decrease from line to line");
        if (sieve.lower > coarser.lower || sieve.upper > coarser.upper)
            refuse(k, "limits: expected them not to increase towards finer sieves");
    }
    require(grading.sieves.size() >= 2,
            path.string() + ":1: expected at least two sieves with limits");
    if (grading.sieves.back().lower == 1)
        refuse(grading.sieves.size() - 1,
               "limits: expected less than 100 % to pass the finest sieve with limits");
    if (grading.sieves.front().lower < 1)
        refuse(0, "limits: expected 100 % to pass the coarsest sieve");
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

Grading read_grading(const std::filesystem::path& path) {
    const CsvTable table = read_csv(path);
    const std::vector<double> size = table.column("sieve_mm"),
                              lower = table.column("lower_percent"),
                              upper = table.column("upper_percent");
    Grading grading{.name = path.stem().string(), .sieves = {}};
    std::vector<int> lines;
    for (std::size_t k = 0; k < size.size(); ++k) {
        if (std::isnan(lower[k]) && std::isnan(upper[k])) continue;
        grading.sieves.push_back({1e-3 * size[k], lower[k] / 100, upper[k] / 100});
        lines.push_back(table.lines[k]);
    }
    check_rows(path, grading, lines);
    return grading;
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

std::string describe(const RockSample& sample, const SieveReport& report) {
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
