#pragma once

#include "scenarios/ballast_box/rail.hpp"

#include <cstddef>
#include <vector>

namespace bris {

/// A stretch of track: rails on ties, and how far their beds have settled.
struct StretchSettings {
    unsigned ties = 41, mud_ties = 3; ///< the mud is in the middle; beyond lie even, good ties
    double spacing = 0.61;            ///< m
    double axle_load = 220e3;         ///< N, of single axles
    double tie_support = 30e6, rail_bending = 1.58e7; ///< N/m, of a tie; N m2, of both rails
    double weight = 4.6e3;                            ///< N, of rails, fastenings and tie

    /// Whether the tie is one of the `count` ties in the middle.
    bool is_in_middle(std::size_t tie, unsigned count) const;
    bool is_mud(std::size_t tie) const { return is_in_middle(tie, mud_ties); }
};

/// The stretch when a good track has settled by `settled`.
struct StretchState {
    double settled = 0;                   ///< m
    double cycles = 0;                    ///< axles, where ballast is computed; 0: not counted
    std::vector<double> settlements = {}; ///< m, of the bed of each tie
    std::vector<double> voids = {};       ///< m, between tie and bed without a train
    /// Largest force of the bed on each tie, over that of an even track.
    std::vector<double> loads = {};
    std::vector<double> profile = {}; ///< m, downwards, of the rail at each tie below an axle there
};

/// The rails over the ties of a stretch and, on either side, over as many even ties as a load is
/// felt over. Gaps below ties emerge from the rail, which is straight where it is not loaded.
class TrackStretch {
public:
    explicit TrackStretch(const StretchSettings& settings);

    /// N, largest force of the bed on a tie as an axle passes, and that on an even track.
    double load(std::size_t tie) { return peak(tie).reaction; }
    double even_load() const { return even_load_; }

    /// The bed of each tie settles (m), and that of the even ties beyond.
    void settle(const std::vector<double>& by, double beyond);
    /// A tamping machine packs ballast below all ties, up to the level of those beyond.
    void tamp();
    /// N/m, of pad, bed and subgrade in series: of each tie, and of the even ties beyond.
    void set_stiffness(const std::vector<double>& of_ties, double beyond);

    StretchState state();
    /// m, of the beds of all ties and of those beyond, as State of a run.
    const std::vector<double>& settlements() const { return levels_; }
    double settled() const { return settled_; }

private:
    struct Peak {
        double reaction, deflection; ///< N, m
    };
    /// With an axle above the tie.
    Peak peak(std::size_t tie);
    void lower_beds();

    StretchSettings settings_;
    std::size_t margin_; ///< even ties on either side
    TrackRail rail_;
    double settled_ = 0, even_load_ = 0; ///< m, of the ties beyond; N
    std::vector<double> levels_;         ///< m
};

/// m, the largest departure of a profile from the middle of a chord, downwards; NaN: the stretch is
/// shorter than the chord.
double dip_over_chord(const std::vector<double>& profile, double spacing, double chord);

} // namespace bris
