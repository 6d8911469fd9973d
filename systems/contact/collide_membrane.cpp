#include "components/kinds.hpp"
#include "components/membrane_surface.hpp"
#include "components/settings.hpp"
#include "engine/parallel.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/scalar_tile.hpp"
#include "systems/contact/smooth_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

using detail::TileTarget;

struct Band {
    MembraneSurface surface;
    const MembraneBands& bands;
    detail::Movers movers;
    const double* speed; // by element
    Foot* foot;          // by near row
    Vec3 centre;         // of the membrane's body
    double deepest;
};

// a sphere is compared with bands from two rings below the first to one above the last
constexpr int lowest_band = MembraneBands::lowest + 1;

void lay_out_bands(const MembraneSurface& surface, MembraneBands& bands) {
    const int rings = surface.rings + MembraneBands::rings_beyond;
    // the sizes are the same in every step
    bands.radii.resize(static_cast<std::size_t>(rings * surface.sectors));
    bands.outward.resize(static_cast<std::size_t>(surface.sectors));
    double* radius = bands.radii.data();
    for (int sector = 0; sector < surface.sectors; ++sector) {
        const Vec3& outward = surface.outward[sector];
        bands.outward[static_cast<std::size_t>(sector)] = {outward.x(), outward.y(), 0, 0};
        for (int ring = 0; ring < rings; ++ring)
            *radius++ = surface.radius_at(ring + MembraneBands::lowest, sector);
    }
}

/// Centres of lane_count near rows against the bands of their sectors.
struct Found {
    unsigned touching; // bit k: lane k
    Lane here, radius, outward_x, outward_y;
    NearestOnBand<Lane> nearest;
};

Found find_touching(const Band& band, const NearEntry* near) {
    const double height = band.surface.ring_height;
    const auto c =
        transpose(load_rows([&](int q) { return &band.movers.sphere_row[near[q].owner].x; }));
    Found f;
    f.radius = c[3];
    f.here = floor(c[2] * (1 / height) - 0.5);
    // a centre that is not a number (NaN) is assigned to some band but does not touch it
    const Lane band_of = min(max(f.here, lanes(lowest_band)), lanes(band.surface.rings)) -
                         static_cast<double>(lowest_band);
    const double* all = band.bands.radii.data();
    const int rings = band.surface.rings + MembraneBands::rings_beyond;
    const auto radii = transpose(load_rows([&](int q) {
        return all + static_cast<int>(near[q].other) * rings + static_cast<int>(band_of[q]);
    }));
    const auto outward =
        transpose(load_rows([&](int q) { return band.bands.outward[near[q].other].data(); }));
    f.outward_x = outward[0];
    f.outward_y = outward[1];
    const Lane out = c[0] * f.outward_x + c[1] * f.outward_y;
    const Lane least = min(min(radii[0], radii[1]), min(radii[2], radii[3]));
    f.touching = bits(out + f.radius >= least);
    if (f.touching == 0) return f;
    f.nearest = nearest_on_band<Lane>(out, c[2] - (f.here + 0.5) * height, radii, height);
    f.touching &= bits(f.nearest.distance < f.radius);
    return f;
}

/// Adds the radial forces of contacts to the two elements of each, as integers.
struct ElementReader {
    const Band* band;
    const NearEntry* near;
    ElementRow* elements; // of the chunk
    double per_force;

    void operator()(const Row* rows, int count, const ForceLanes& force, unsigned left_out) const {
        const auto integer = [](double x) { return std::llrint(x); };
        const auto add = [](std::int64_t& sum, std::int64_t more) { // may wrap (sum_membrane)
            sum = static_cast<std::int64_t>(static_cast<std::uint64_t>(sum) +
                                            static_cast<std::uint64_t>(more));
        };
        for (int q = 0; q < count; ++q) {
            if ((left_out >> q) & 1) continue;
            const Row row = rows[q];
            const Foot& foot = band->foot[row];
            const Vec3& outward = band->surface.outward[near[row].other];
            const double radial = -(force.x[q] * outward.x() + force.y[q] * outward.y());
            ElementRow &lower = elements[foot.lower], &upper = elements[foot.upper];
            add(lower.push, integer(per_force * ((1 - foot.share) * radial)));
            add(upper.push, integer(per_force * (foot.share * radial)));
            lower.hold += integer((1 - foot.share) / ElementSums::hold_unit);
            upper.hold += integer(foot.share / ElementSums::hold_unit);
        }
    }
};
template <class Law>
using Tile = detail::ScalarTile<Law, ElementReader>;

template <class Law>
void add_touching(const Found& f, unsigned touching, const Band& band, const TileTarget& to,
                  Row first, Tile<Law>& tile) {
    for (; touching != 0; touching &= touching - 1) {
        const int k = __builtin_ctz(touching);
        const Row row = first + static_cast<Row>(k);
        const Foot foot =
            band.surface.foot(static_cast<int>(f.here[k] + f.nearest.strip[k]),
                              static_cast<int>(to.near[row].other), f.nearest.share[k]);
        band.foot[row] = foot;
        const double speed =
            (1 - foot.share) * band.speed[foot.lower] + foot.share * band.speed[foot.upper];
        const Vec3 outward(f.outward_x[k], f.outward_y[k], 0);
        const double radial = f.nearest.radial[k];
        tile.add(row, Vec3(radial * outward.x(), radial * outward.y(), f.nearest.axial[k]),
                 f.nearest.distance[k], {speed * outward, Vec3::Zero(), band.centre});
    }
}

template <class Law>
void collide_chunk(const TileTarget& to, const Band& band, NearIndex<MembranePairs>& index,
                   ElementSums& sums, std::size_t chunk) {
    const NearChunk& here = index.chunks[chunk];
    ElementRow* elements = sums.rows.data() + chunk * sums.elements;
    std::fill_n(elements, sums.elements, ElementRow{});
    Tile<Law> tile(to, band.movers, band.deepest, index.beyond_limit[chunk],
                   {&band, to.near, elements, to.sums.per_force});
    for (Row group = here.first; group < here.last; group += 8) {
        const unsigned valid = here.last - group < 8 ? (1u << (here.last - group)) - 1 : 0xff;
        unsigned now = 0;
        for (unsigned lane = 0; lane < 8; lane += lane_count) {
            const Row row = group + lane;
            const Found found = find_touching(band, to.near + row);
            const unsigned touching = found.touching & (valid >> lane);
            if (touching == 0) continue;
            add_touching(found, touching, band, to, row, tile);
            now |= touching << lane;
        }
        index.touching[here.first_flags + (group - here.first) / 8] =
            static_cast<std::uint8_t>(now);
    }
    tile.flush();
}

// a membrane has no friction, whatever the law between grains is
template <class Law, class... Work>
void collide(Rows<NearMembrane, const NearPair, const PartnerSum, PairForce, FootOf> near,
             detail::ListedSpheres listed, detail::MovingBodies<Law, Work...> bodies,
             Rows<Bodies, const Position> positions,
             Rows<Elements, const ElementRadius, const ElementSpeed> elements, ElementSums& sums,
             NearIndex<MembranePairs>& index, MembraneBands& bands, const Membrane& membrane,
             Rows<ForceSums, ContactSum> force_sums, const ForceGrid& grid,
             const Materials& materials, const Limits& limits, const Observation& observation,
             const Clock& clock) {
    const TileTarget to =
        detail::target_of<Law>(near, Rows<MembranePairs>({}, 0, {}), bodies,
                               {force_sums, grid, materials, limits, observation, clock});
    const MembraneSurface surface(membrane, elements.column<ElementRadius>());
    lay_out_bands(surface, bands);
    sums.elements = elements.size();
    sums.rows.resize(index.chunks.size() * sums.elements); // allocates only after new lists
    const Band band{surface,
                    bands,
                    {listed, bodies, index},
                    elements.column<ElementSpeed>(),
                    near.template column<FootOf>(),
                    positions.column<Position>()[membrane.body_row],
                    limits.overlap_of_contacts()};
    for_chunks(index.chunks.size(), 1, [&](std::size_t chunk, std::size_t, std::size_t) {
        collide_chunk<Law>(to, band, index, sums, chunk);
    });
}

} // namespace

System collide_membrane(LawName law, const StepChoices& choices) {
    return system_of_smooth_law(law, choices, []<class Smooth, class... Work>() {
        return system("collide_membrane", collide<Smooth, Work...>);
    });
}

} // namespace bris
