#include "scenarios/track/stretch.hpp"

#include "engine/errors.hpp"
#include "scenarios/ballast_box/train.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

std::size_t margin_of(const StretchSettings& s) {
    const RailOnTies even{s.rail_bending, s.tie_support, s.spacing, s.weight};
    return static_cast<std::size_t>(std::ceil(6 / even.wave_number() / s.spacing));
}

TrackRail rail_over(const StretchSettings& s, std::size_t margin,
                    const std::vector<double>& of_ties, double beyond) {
    std::vector<double> at;
    std::vector<TieSupport> supports;
    for (std::size_t k = 0; k < s.ties + 2 * margin; ++k) {
        const bool within = k >= margin && k < margin + s.ties;
        at.push_back(s.spacing * static_cast<double>(k));
        supports.push_back({.stiffness = within ? of_ties[k - margin] : beyond});
    }
    return {std::move(at), std::move(supports), s.rail_bending, s.weight};
}

TrackRail even_rail(const StretchSettings& s, std::size_t margin, double stiffness) {
    return rail_over(s, margin, std::vector<double>(s.ties, stiffness), stiffness);
}

double even_load_on(const StretchSettings& s, std::size_t margin, double stiffness) {
    const std::size_t middle = margin + s.ties / 2;
    const RailLoad axle{s.spacing * static_cast<double>(middle), s.axle_load};
    return even_rail(s, margin, stiffness).under({&axle, 1}).reactions[middle];
}

} // namespace

bool StretchSettings::is_in_middle(std::size_t tie, unsigned count) const {
    const std::size_t first = (ties - count) / 2;
    return tie >= first && tie < first + count;
}

TrackStretch::TrackStretch(const StretchSettings& settings)
    : settings_(settings), margin_(margin_of(settings)),
      rail_(even_rail(settings, margin_, settings.tie_support)),
      even_load_(even_load_on(settings, margin_, settings.tie_support)), levels_(settings.ties, 0) {
    require(settings.ties > 0 && settings.mud_ties <= settings.ties,
            "track: expected at most as many ties of mud as there are ties");
}

void TrackStretch::settle(const std::vector<double>& by, double beyond) {
    for (std::size_t i = 0; i < levels_.size(); ++i) levels_[i] += by[i];
    settled_ += beyond;
    lower_beds();
}

void TrackStretch::tamp() {
    std::ranges::fill(levels_, settled_);
    lower_beds();
}

void TrackStretch::set_stiffness(const std::vector<double>& of_ties, double beyond) {
    rail_ = rail_over(settings_, margin_, of_ties, beyond);
    even_load_ = even_load_on(settings_, margin_, beyond);
    lower_beds();
}

StretchState TrackStretch::state() {
    StretchState s{.settled = settled_, .settlements = levels_};
    const auto unloaded = rail_.under({});
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        const double rail = unloaded.at_ties[margin_ + i];
        s.voids.push_back(std::max(0.0, levels_[i] - settled_ - rail));
        const Peak p = peak(i);
        s.loads.push_back(p.reaction / even_load_);
        s.profile.push_back(settled_ + p.deflection);
    }
    return s;
}

TrackStretch::Peak TrackStretch::peak(std::size_t tie) {
    const std::size_t k = margin_ + tie;
    const RailLoad axle{settings_.spacing * static_cast<double>(k), settings_.axle_load};
    const auto found = rail_.under({&axle, 1});
    return {found.reactions[k], found.at_ties[k]};
}

// levels count from those of the even ties beyond the stretch
void TrackStretch::lower_beds() {
    for (std::size_t i = 0; i < levels_.size(); ++i)
        rail_.set_gap(margin_ + i, levels_[i] - settled_);
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
