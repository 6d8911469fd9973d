#include "systems/contact/share_patches.hpp"

#include "engine/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

// converts the overlaps of a patch, share[k] for the rows k that `belongs` accepts, into shares
template <class Belongs>
void normalise(double* share, Row first, Row last, Belongs&& belongs) {
    double sum = 0;
    for (Row k = first; k < last; ++k)
        if (belongs(k)) sum += share[k];
    for (Row k = first; k < last; ++k)
        if (belongs(k)) share[k] = sum > 0 ? share[k] / sum : 1;
}

// calls share_rows(first, last) with the range of near rows of every owner
template <class Pairs, class ShareRows>
void for_owners(const NearIndex<Pairs>& index, ShareRows&& share_rows) {
    for_chunks(index.chunks.size(), 1, [&](std::size_t chunk, std::size_t, std::size_t) {
        const NearChunk& here = index.chunks[chunk];
        for (Row b = here.first_body; b < here.last_body; ++b)
            share_rows(index.owned_first[b], index.owned_first[b + 1]);
    });
}

} // namespace

void share_sphere_patches(Rows<NearSpheres, const NearPair, PatchShare> near,
                          Rows<Listed, const ListedPosition, const ListedBody> listed,
                          const NearIndex<SpherePairs>& index) {
    const NearEntry* entry = near.column<NearPair>();
    const SphereRow* sphere_row = listed.column<ListedPosition>();
    const Row* body = listed.column<ListedBody>();
    double* share = near.column<PatchShare>();
    const auto overlap = [&](Row k) {
        const SphereRow &a = sphere_row[entry[k].owner], &b = sphere_row[entry[k].other];
        const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
        return std::max(0.0, a.radius + b.radius - std::sqrt(dx * dx + dy * dy + dz * dz));
    };
    for_owners(index, [&](Row first, Row last) {
        for (Row k = first; k < last;) { // pairs with one partner are contiguous
            const Row patch = k, partner = body[entry[k].other];
            for (; k < last && body[entry[k].other] == partner; ++k) share[k] = overlap(k);
            normalise(share, patch, k, [](Row) { return true; });
        }
    });
}

void share_plane_patches(Rows<NearPlanes, const NearPair, PatchShare> near,
                         Rows<Listed, const ListedPosition, const ListedBody> listed,
                         Rows<Planes, const PlanePosition> planes,
                         const NearIndex<PlanePairs>& index) {
    const NearEntry* entry = near.column<NearPair>();
    const SphereRow* sphere_row = listed.column<ListedPosition>();
    const PlaneRow* plane = planes.column<PlanePosition>();
    double* share = near.column<PatchShare>();
    const auto count = static_cast<Row>(planes.size());
    for_owners(index, [&](Row first, Row last) {
        for (Row k = first; k < last; ++k) {
            const SphereRow& a = sphere_row[entry[k].owner];
            const PlaneRow& p = plane[entry[k].other];
            share[k] = std::max(0.0, a.radius - (Vec3(a.x, a.y, a.z) - p.point).dot(p.normal));
        }
        if (first == last) return;
        for (Row p = 0; p < count; ++p)
            normalise(share, first, last, [&](Row k) { return entry[k].other == p; });
    });
}

} // namespace bris
