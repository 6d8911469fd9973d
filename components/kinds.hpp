#pragma once

namespace bris {

// Kinds name the tables of a scene. Every boundary is a body; every sphere, facet and plane belongs
// to a body. A pair table holds the candidate pairs with their history; its short list holds the
// pairs that are near at present.

struct Bodies {
    static constexpr auto name = "bodies";
};
struct Spheres {
    static constexpr auto name = "spheres";
};
struct Facets {
    static constexpr auto name = "facets";
};
struct Planes {
    static constexpr auto name = "planes";
};
/// Elements of a rigid membrane.
struct Elements {
    static constexpr auto name = "elements";
};
/// Nodes and triangles of a sleeve of latex.
struct Nodes {
    static constexpr auto name = "nodes";
};
struct Triangles {
    static constexpr auto name = "triangles";
};
/// Packed rows of the spheres that are on any short list, body by body. Single spheres are all
/// listed, in the rows of their bodies.
struct Listed {
    static constexpr auto name = "listed";
};

/// Sums of contact forces: a row for each body, in the order of Bodies, and then rows for the
/// forces on bodies that another chunk of near rows owns.
struct ForceSums {
    static constexpr auto name = "force_sums";
};

struct NearSpheres {
    static constexpr auto name = "near_spheres";
};
struct NearFacets {
    static constexpr auto name = "near_facets";
};
struct NearPlanes {
    static constexpr auto name = "near_planes";
};
struct NearMembrane {
    static constexpr auto name = "near_membrane";
};

// rows_per_flag: near rows per byte of touching flags. Facets have one row per byte, because the
// runs of rows that are reduced together would cross bytes.
struct SpherePairs {
    static constexpr auto name = "sphere_pairs";
    using Near = NearSpheres;
    static constexpr unsigned rows_per_flag = 8;
};
struct FacetPairs {
    static constexpr auto name = "facet_pairs";
    using Near = NearFacets;
    static constexpr unsigned rows_per_flag = 1;
};
struct PlanePairs {
    static constexpr auto name = "plane_pairs";
    using Near = NearPlanes;
    static constexpr unsigned rows_per_flag = 8;
};
struct MembranePairs {
    static constexpr auto name = "membrane_pairs";
    using Near = NearMembrane;
    static constexpr unsigned rows_per_flag = 8;
};

/// Calls visit.template operator()<Pairs>() for every kind of pair, in the order in which forces
/// are summed.
template <class Visit>
void for_each_kind_of_pair(Visit&& visit) {
    visit.template operator()<SpherePairs>();
    visit.template operator()<FacetPairs>();
    visit.template operator()<PlanePairs>();
    visit.template operator()<MembranePairs>();
}

} // namespace bris
