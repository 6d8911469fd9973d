#pragma once

#include "scenarios/ballast_box/rail.hpp"
#include "systems/loads/load.hpp"

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// An axle of a train.
struct Axle {
    double behind; ///< m, distance behind the first axle
    double load;   ///< N, of both wheels
};

/// A train: its axles from front to rear, the first one at 0.
struct Train {
    std::string name;
    std::vector<Axle> axles;
    /// How the file was read, for people, where it is not in the form of assets/trains; else "".
    std::string read_as = {};
    double length() const { return axles.back().behind; } ///< m, from first to last axle
};

/// The train of that name (assets/trains), or of a table (read_text_table). It has a column with
/// the positions of the axles, distances behind the first one, ascending from 0, or with their
/// spacings, each the distance behind the axle before (the first one is 0), in m, cm, mm or ft, and
/// one with the axle loads, above 0 and at most 500 kN, in kN, N, t, kg, kip or lbf. Throws
/// InputError, naming the option or the file with its line, and OutputError.
Train train_named(const std::string& name, const std::string& option = "--train");

/// Prints one line if the file of the train is in another form than those of assets/trains.
void say_how_read(const Train& train);

/// A straight track with the same support under all ties.
struct RailOnTies {
    double bending;     ///< N m2, stiffness E I of both rails together, > 0
    double tie_support; ///< N/m, of pads, bed and subgrade of a whole tie in series, > 0
    double spacing;     ///< m, of the ties, > 0
    double tie_weight;  ///< N
    /// N/m, of the pads of a tie, by which rails push one that is modelled itself.
    double pad = std::numeric_limits<double>::infinity();
    /// 1/m, (k / (4 E I))^(1/4) with the track modulus k = tie_support / spacing.
    double wave_number() const;
    /// m, distance beyond which a tie carries less than 1e-5 of what it does under the axle; to
    /// there the rail is modelled on either side.
    double reach() const;
    /// Ties on either side of the one in the middle, which is at 0 m.
    std::size_t ties_on_each_side() const;
    /// `of_rails`: N, weight of rails and fastenings on a tie; `gap`: m, under the middle tie.
    TrackRail rail(double of_rails, double gap = 0) const;
    /// Of the tie in the middle.
    InfluenceLine influence() const;
    double stiffness_without_tie() const; ///< N/m, TrackRail::stiffness_without
};

/// `force` of the places and loads of all axles while a train passes the middle tie, which is at 0,
/// at constant speed (m/s). The first axle is reach() before it at time 0, and the last one reach()
/// behind it at the end. Values every millisecond.
LoadHistory history_of_passage(const Train& train, double speed, const RailOnTies& rails,
                               const std::function<double(std::span<const RailLoad>)>& force);

/// The force (N, downwards) of the rails on a tie in that time, without the dynamics of the
/// vehicles: what the bed carries there (TrackRail) less the weight of the tie. So `dead_load` (N,
/// of rails and fastenings) is left at both ends, to 1e-5 of an axle's load, and a tie at most
/// hangs from the rails.
LoadHistory passing_load(const Train& train, double speed, const RailOnTies& rails,
                         double dead_load);

/// s, length of that history.
double passing_time(const Train& train, double speed, const RailOnTies& rails);

} // namespace bris
