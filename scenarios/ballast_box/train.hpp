#pragma once

#include "systems/loads/load.hpp"

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

/// Rails on ties as a beam on a Winkler foundation (S. Timoshenko, Method of analysis of statical
/// and dynamical stresses in rail, Proc. 2nd Int. Congr. Appl. Mech., 1926).
struct RailOnTies {
    double bending;     ///< N m2, stiffness E I of both rails together, > 0
    double tie_support; ///< N/m, stiffness of the support of a whole tie, > 0
    double spacing;     ///< m, of the ties, > 0
    /// 1/m, (k / (4 E I))^(1/4) with the track modulus k = tie_support / spacing.
    double wave_number() const;
    /// Part of an axle's load that the tie at distance `x` (m) along the track carries: spacing
    /// beta / 2 exp(-beta |x|) (cos beta |x| + sin beta |x|). Negative where the rails lift the
    /// tie. The parts of all ties add up to 1, to 8 (beta spacing / (2 pi))^4.
    double share(double x) const;
    /// N/m, force on the rails at a tie over their deflection there if this tie did not support
    /// them: 2 k / beta - tie_support, by superposition, as the deflection under a load is beta /
    /// (2 k).
    double stiffness_without_tie() const;
    /// m, distance beyond which the part is less than 1e-5 of that under the axle.
    double reach() const;
};

/// The force (N, downwards) of the rails on a tie while a train passes at constant speed (m/s),
/// without the dynamics of the vehicles: `dead_load` (N, of rails and fastenings) plus the parts of
/// all axles. The first axle is reach() before the tie at time 0; the last value, with the last
/// axle reach() behind it, is `dead_load` to 1e-5 of an axle's load. Values every millisecond.
LoadHistory passing_load(const Train& train, double speed, const RailOnTies& rails,
                         double dead_load);

/// s, length of that history.
double passing_time(const Train& train, double speed, const RailOnTies& rails);

} // namespace bris
