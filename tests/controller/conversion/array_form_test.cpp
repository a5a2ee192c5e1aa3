#include <catch2/catch.hpp>

#include <array>

#include "shape_fixture.hpp"

namespace array_form_test {

using namespace busbar;
using namespace busbar::test;
using controller::array_form;
using controller::ArrayForm;

namespace {

using Dimensions = std::vector<std::uint32_t>;

// The columns of the table, with n = 2, m = 3, k = 4.
const std::array<Dimensions, 9> columns{{
    {},
    {2},
    {0},
    {2, 3},
    {2, 0},
    {0, 0},
    {2, 3, 4},
    {2, 3, 0},
    {0, 0, 0},
}};

/// '+' can be assigned, '^' with limitations, 'x' cannot be used.
struct Row {
    std::int32_t value_rank;
    std::string_view cells;
    std::uint8_t rank;
};
constexpr std::array rows{
    Row{-3, "^^^^^^^^^", 1}, // one cell for all columns
    Row{-2, "^^^^^^^^^", 1},        Row{0, "^^^^^^^^^", 1},         Row{-1, "+++++++++", 0},
    Row{1, "^+^xxxxxx", 1},         Row{2, "^xx+x^xxx", 2},         Row{3, "^xxxxx+x^", 3},
    Row{4, "xxxxxxxxx", 0},         Row{16, "xxxxxxxxx", 0},        Row{-4, "xxxxxxxxx", 0},
    Row{INT32_MIN, "xxxxxxxxx", 0}, Row{INT32_MAX, "xxxxxxxxx", 0},
};

char cell(const ArrayForm& form)
{
    return form.use == ArrayUse::No ? 'x' : form.use == ArrayUse::Limited ? '^' : '+';
}

/// Elements of a cell: {n}, {n,m} and so on, 1 of limited ones.
std::size_t elements(char cell, const Dimensions& dimensions, std::uint8_t rank)
{
    std::size_t product = 1;
    for (const std::uint32_t dimension : dimensions) {
        product *= cell == '+' && rank > 0 ? dimension : 1;
    }
    return product;
}

ArrayForm chosen(std::int32_t value_rank, Dimensions dimensions, MappingArray array,
                 const ShapeLimits& limits = ShapeLimits::rd81opc96())
{
    return array_form(value_rank, dimensions, &array, false, limits);
}

std::vector<std::uint32_t> lengths(const ArrayForm& form)
{
    return {form.dimensions.begin(), form.dimensions.begin() + form.rank};
}

} // namespace

TEST_CASE("8.2 Array assignment method: each cell of ValueRank and ArrayDimensions", "[8.2]")
{
    for (const Row& row : rows) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            CAPTURE(row.value_rank, i);
            const ArrayForm form = array_form(row.value_rank, columns[i], nullptr, false);
            CHECK(cell(form) == row.cells[i]);
            if (form.use != ArrayUse::No) {
                CHECK(form.rank == row.rank);
                CHECK(form.elements() == elements(row.cells[i], columns[i], row.rank));
            }
            CHECK(form.is_open == (row.cells[i] == '^'));
            // Note 2: an Argument has no limited assignment.
            const ArrayForm argument = array_form(row.value_rank, columns[i], nullptr, true);
            CHECK(cell(argument) == (row.cells[i] == '^' ? 'x' : row.cells[i]));
        }
    }
}

TEST_CASE("8.2 Array assignment method: at most 10,240 elements", "[8.2]")
{
    const ShapeLimits limits = ShapeLimits::rd81opc96();
    const auto use = [&](Dimensions dimensions) {
        const auto rank = static_cast<std::int32_t>(dimensions.size());
        return cell(array_form(rank, dimensions, nullptr, false, limits));
    };
    CHECK(use({10'240}) == '+');
    CHECK(use({10'241}) == 'x');
    CHECK(use({1'024, 10}) == '+');
    CHECK(use({1'025, 10}) == 'x');
    CHECK(use({32, 32, 10}) == '+');
    CHECK(use({32, 32, 11}) == 'x');
    CHECK(use({UINT32_MAX, UINT32_MAX, UINT32_MAX}) == 'x');
    const Dimensions larger{10'241};
    CHECK(array_form(1, larger, nullptr, false, limits).is_too_large);
    CHECK(cell(array_form(1, larger, nullptr, false)) == '+'); // without the preset
}

TEST_CASE("8.2 Limited assignment: Rank decides where ValueRank does not", "[8.2]")
{
    const auto rank = [](std::int32_t value_rank, std::int32_t wanted) {
        const ArrayForm form = chosen(value_rank, {}, {"", wanted, {2, 3, 4}});
        CHECK(cell(form) == '^');
        return lengths(form);
    };
    CHECK(rank(-2, -1) == Dimensions{});
    CHECK(rank(-2, 1) == Dimensions{2});
    CHECK(rank(-2, 2) == Dimensions{2, 3});
    CHECK(rank(-2, 3) == Dimensions{2, 3, 4});
    CHECK(rank(-3, -1) == Dimensions{});
    CHECK(rank(-3, 1) == Dimensions{2});
    CHECK(rank(0, 3) == Dimensions{2, 3, 4});
    // What the ValueRank forbids is as if it were not there.
    CHECK(rank(-3, 2) == Dimensions{1});
    CHECK(rank(0, -1) == Dimensions{1});
    CHECK(rank(-2, 4) == Dimensions{1});
    CHECK(rank(-2, 0) == Dimensions{1});
}

TEST_CASE("8.2 Limited assignment: Dim 1 to 3 are followed", "[8.2]")
{
    CHECK(lengths(chosen(1, {0}, {"", 1, {7}})) == Dimensions{7});
    CHECK(lengths(chosen(2, {}, {"", 1, {7, 2}})) == Dimensions{7, 2}); // not Rank
    CHECK(lengths(chosen(3, {0, 0, 0}, {"", 1, {7, 2, 5}})) == Dimensions{7, 2, 5});
    CHECK(lengths(chosen(2, {0, 0}, {"", 1, {7}})) == Dimensions{7, 1});
    CHECK(lengths(chosen(1, {0}, {"", 1, {10'240}})) == Dimensions{10'240});
    CHECK(lengths(chosen(1, {0}, {"", 1, {10'241}})) == Dimensions{1});
    CHECK(lengths(chosen(2, {0, 0}, {"", 1, {10'240, 2}})) == Dimensions{1, 1}); // the product
    CHECK(lengths(chosen(1, {5}, {"", 1, {7}})) == Dimensions{5}); // nothing to choose
    CHECK_FALSE(chosen(1, {0}, {"", 1, {7}}).is_open);
}

} // namespace array_form_test
