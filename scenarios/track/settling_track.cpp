#include "scenarios/track/settling_track.hpp"

#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/ballast_box/train.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr std::uint64_t stream = 671; // of random numbers

/// The rail over the stretch and, on either side, as many even ties as a load is felt over.
class Stretch {
public:
    Stretch(const SettlingTrack& track, std::uint64_t number)
        : track_(track), margin_(margin_of(track)), rail_(make_rail(track, margin_)),
          levels_(track.ties, 0), rates_(track.ties) {
        Random random(number, stream);
        for (std::size_t i = 0; i < track.ties; ++i)
            rates_[i] =
                (track.is_mud(i) ? track.ratio : 1) * std::exp(track.scatter * random.normal());
        even_ = peak(margin_ + track.ties / 2).reaction; // all levels are 0
    }

    /// Until a good track has settled by `until` (m).
    void settle(double until) {
        constexpr double most_blocks = 20'000;
        const double step = track_.block * even_ / track_.tie_support;
        require(until <= most_blocks * step,
                fmt::format("track: expected a settlement of at most {:.3g} mm, {:g} blocks, found "
                            "{:.3g} mm",
                            1e3 * most_blocks * step, most_blocks, 1e3 * until));
        while (settled_ < until) {
            double fastest = 1;
            std::vector<double> rates;
            for (std::size_t i = 0; i < track_.ties; ++i) {
                const double load = peak(margin_ + i).reaction / even_;
                rates.push_back(rates_[i] * std::pow(load, track_.exponent));
                fastest = std::max(fastest, rates.back());
            }
            const double by = std::min(step / fastest, until - settled_);
            for (std::size_t i = 0; i < track_.ties; ++i) levels_[i] += rates[i] * by;
            settled_ += by;
            if (until - settled_ < 1e-12) settled_ = until;
            lower_beds();
        }
    }

    StretchState state() {
        StretchState s{.settled = settled_, .settlements = levels_};
        const auto unloaded = rail_.under({});
        for (std::size_t i = 0; i < track_.ties; ++i) {
            const std::size_t tie = margin_ + i;
            s.voids.push_back(std::max(0.0, levels_[i] - settled_ - unloaded.at_ties[tie]));
            const Peak p = peak(tie);
            s.loads.push_back(p.reaction / even_);
            s.profile.push_back(settled_ + p.deflection);
        }
        return s;
    }

private:
    struct Peak {
        double reaction, deflection; ///< N, m
    };

    static std::size_t margin_of(const SettlingTrack& t) {
        const RailOnTies even{t.rail_bending, t.tie_support, t.spacing, t.weight};
        return static_cast<std::size_t>(std::ceil(6 / even.wave_number() / t.spacing));
    }
    static TrackRail make_rail(const SettlingTrack& t, std::size_t margin) {
        std::vector<double> at;
        for (std::size_t k = 0; k < t.ties + 2 * margin; ++k)
            at.push_back(t.spacing * static_cast<double>(k));
        std::vector<TieSupport> supports(at.size(), {.stiffness = t.tie_support});
        return {std::move(at), std::move(supports), t.rail_bending, t.weight};
    }
    /// With an axle above the tie.
    Peak peak(std::size_t tie) {
        const RailLoad axle{track_.spacing * static_cast<double>(tie), track_.axle_load};
        const auto found = rail_.under({&axle, 1});
        return {found.reactions[tie], found.at_ties[tie]};
    }
    /// Levels count from those of the good ties beyond the stretch.
    void lower_beds() {
        for (std::size_t i = 0; i < track_.ties; ++i)
            rail_.set_gap(margin_ + i, levels_[i] - settled_);
    }

    SettlingTrack track_;
    std::size_t margin_;
    TrackRail rail_;
    double settled_ = 0, even_ = 0;
    std::vector<double> levels_, rates_;
};

} // namespace

bool SettlingTrack::is_mud(std::size_t tie) const {
    const std::size_t first = (ties - mud_ties) / 2;
    return tie >= first && tie < first + mud_ties;
}

std::vector<StretchState> settle_track(const SettlingTrack& track,
                                       const std::vector<double>& settlements,
                                       std::uint64_t number) {
    require(track.ties > 0 && track.mud_ties <= track.ties,
            "track: expected at most as many ties of mud as there are ties");
    require(std::ranges::is_sorted(settlements), "track: expected ascending settlements");
    Stretch stretch(track, number);
    std::vector<StretchState> states;
    for (const double settled : settlements) {
        stretch.settle(settled);
        states.push_back(stretch.state());
    }
    return states;
}

double dip_over_chord(const std::vector<double>& profile, double spacing, double chord) {
    const double last = static_cast<double>(profile.size()) - 1, half = chord / 2 / spacing;
    const auto at = [&](double x) {
        const auto k = static_cast<std::size_t>(std::min(x, last - 1));
        const double part = x - static_cast<double>(k);
        return (1 - part) * profile[k] + part * profile[k + 1];
    };
    double dip = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t k = 0; k < profile.size(); ++k) {
        const auto middle = static_cast<double>(k);
        if (middle < half || middle + half > last) continue;
        const double below = profile[k] - 0.5 * (at(middle - half) + at(middle + half));
        dip = std::isnan(dip) ? below : std::max(dip, below);
    }
    return dip;
}

} // namespace bris
