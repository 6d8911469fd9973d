#pragma once

#include "components/fouling.hpp"
#include "engine/clock.hpp"
#include "systems/fields/solid_fraction.hpp"

#include <string>

namespace bris {

/// Properties of fines, and how their fields are kept.
struct FoulingSettings {
    double density = 2600;         ///< kg/m3, of the particles, > 0
    double void_ratio = 0.8;       ///< of fines in the voids of ballast, > 0
    double least_void_ratio = 0.4; ///< of compacted fines, in (0, void_ratio]: what a void can hold
    double silt = 0.15;            ///< share of the fines that passes 0.075 mm, in [0, 1]
    double size = 2e-4;            ///< m, effective size of the fines for the flow of water, > 0
    double ballast_size = 0.03;    ///< m, the same of the ballast
    double voxel = 5e-3;           ///< m, edge of the voxels, > 0
    unsigned samples = 3;          ///< lines across each edge of a voxel (SolidFraction), 2 to 64
    /// The fields are brought up to date when a point of a rock has moved by this share of a voxel,
    /// > 0; looked at every `check_every` steps, > 0.
    double refresh = 0.1;
    unsigned check_every = 50;
    /// m2/s and m/s, spreading of fines and their upward speed under cyclic load (mud pumping);
    /// 0: fines move only with rocks.
    double diffusivity = 0, pumping = 0;
    bool drains = false; ///< water drains, through the base too
    bool moves() const { return diffusivity > 0 || pumping != 0 || drains; }

    static auto fields(auto& s) {
        return std::tie(s.density, s.void_ratio, s.least_void_ratio, s.silt, s.size, s.ballast_size,
                        s.voxel, s.samples, s.refresh, s.check_every, s.diffusivity, s.pumping,
                        s.drains);
    }
};

/// The fields of fines and water of a scene. Masses and volumes are multiples of powers of two, so
/// that moving them is exact.
struct Fouling {
    static constexpr auto name = "fouling";
    static constexpr bool is_state = true, changes_in_whole_steps_only = true;

    FoulingSettings settings;
    Box3 box; ///< m, in which fields exist besides those of planes and membrane
    std::vector<Box3> blocked = {}; ///< m, within the box, where bodies of facets leave no voids
    Box3 region;                    ///< m, that the fields have covered so far
    VoxelBlocks blocks;
    VoxelField fines;                      ///< kg, in each voxel of the blocks
    VoxelField water;                      ///< m3
    double fines_unit = 0, water_unit = 0; ///< of which the values are multiples; 0: there are none
    double fines_beyond = 0, water_beyond = 0; ///< kg, m3, that no void near them can hold
    double drained = 0;                        ///< m3, has left through the base
    double updated_at = 0;                     ///< s
    bool stale = true;          ///< to be brought up to date at the beginning of the next step
    bool is_fixed = false;      ///< the fields were given up (fix_fouling)
    SolidFraction solid;        ///< Derived, on the same blocks once it is up to date
    std::uint64_t revision = 0; ///< Derived: counts changes of what bodies see
    std::uint64_t updates = 0;  ///< Derived: for reports

    /// Whether a step looks if the fields must be brought up to date.
    bool is_checked(std::uint64_t step) const {
        return !is_fixed && (stale || step % settings.check_every == 0);
    }
    void save(Archive& archive) const;
    void load(const Archive& archive);
};

/// A box without limits, for scenes that planes and membrane bound.
Box3 unbounded();
/// Adds empty fields to a scene, and to its bodies what they see of them; if it was started
/// already, Simulation::prepare must be called. `box` bounds the fields together with planes and
/// membrane. Throws InputError if settings are out of range.
void add_fouling(World& world, const FoulingSettings& settings, const FoulingLaw& law = {},
                 const Box3& box = unbounded());
/// Measures the voids of the present rocks. Throws InputError if planes, membrane and box do not
/// bound the space, or if a rock lies outside it that is not fixed there, where it waits.
void prepare_voids(World& world);

/// Whether the fields must be brought up to date in this step: rocks have moved, or fines and water
/// move by themselves. False without fouling.
bool fouling_is_due(const World& world);

/// Brings the fields up to date with the rocks: fines and water that a rock displaces go to the
/// voids beside it, then they migrate and drain for the time since the last update, and every body
/// takes up the fouling of the voids around it.
void update_fouling(World& world, Fouling& fouling);

/// From now on each body keeps the fouling around it, wherever it goes, and there are no fields any
/// more: on ranks no step needs the whole world for them. Throws InputError if fines and water move
/// by themselves.
void fix_fouling(World& world);

/// Whether a scene has fines and water whose fields were not given up.
bool has_fouling_fields(const World& world);
/// A copy of the fields on the voids that the rocks leave at present, for readers; the world stays
/// as it is. Throws InputError if they were given up.
Fouling present_fouling(const World& world);

/// Measures of fouling of a whole specimen, of the part between two heights, or around a body.
struct FoulingMeasures {
    double ballast_mass = 0, fines_mass = 0; ///< kg
    double void_volume = 0;                  ///< m3, that the ballast leaves
    double water_volume = 0;                 ///< m3
    double p4 = 0, p200 = 0;                 ///< %, passing 4.75 mm and 0.075 mm, by mass
    double fouling_index = 0;                ///< FI = P4 + P200 (Selig and Waters 1994)
    /// %, 100 (1 + e_f) M_f / (rho_f V_v): volume of the fines with their pores over that of the
    /// voids (void contaminant index; Indraratna, Tennakoon et al. 2011).
    double contaminant_index = 0;
    /// %, the same for compacted fines (percentage void contamination; Feldman and Nissen 2002).
    double void_contamination = 0;
    double saturation = 0; ///< %, of the voids that the fines leave
};
/// Fills in the ratios from the masses and volumes.
void complete(FoulingMeasures& measures, const FoulingSettings& settings);

/// Of all rocks, or of the space between two heights (m). `present` is of present_fouling.
FoulingMeasures measure_fouling(const World& world, const Fouling& present);
FoulingMeasures measure_fouling(const World& world, const Fouling& present, double low,
                                double high);

/// Class of Selig and Waters (1994): clean (FI below 1), moderately clean (below 10), moderately
/// fouled (below 20), fouled (below 40), highly fouled.
std::string fouling_class(double fouling_index);

} // namespace bris
