#include "scenarios/python/arrays.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

namespace bris {

namespace py = pybind11;

std::vector<py::ssize_t> shape_of(std::size_t rows, std::size_t columns) {
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows)};
    if (columns != 1) shape.push_back(static_cast<py::ssize_t>(columns));
    return shape;
}

py::dtype dtype_of(Scalar scalar, std::size_t scalar_size) {
    const bool real = scalar == Scalar::real;
    require(scalar_size == 8 || scalar_size == 4 || (!real && scalar_size <= 2),
            fmt::format("expected numbers of a size that NumPy has, found {} bytes", scalar_size));
    return py::dtype(fmt::format("{}{}", real ? 'f' : 'u', scalar_size));
}

py::dict arrays_of(const Archive& archive) {
    py::dict arrays;
    for (const Archive::Array& a : archive.arrays())
        arrays[py::str(a.path)] = py::array(dtype_of(a.scalar, a.scalar_size),
                                            shape_of(a.rows(), a.columns), a.bytes.data());
    return arrays;
}

py::array view_of(Column& column, const py::object& owner, bool writable) {
    const Column::Type& type = column.type();
    py::array view(dtype_of(type.scalar, type.scalar_size),
                   shape_of(column.size(), type.value_size / type.scalar_size), column.bytes(),
                   owner);
    if (!writable) view.attr("setflags")(py::arg("write") = false);
    return view;
}

} // namespace bris
