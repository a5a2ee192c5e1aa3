#include <catch2/catch.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "label_values.hpp"

namespace float_conversion_test {

using namespace busbar;
using namespace busbar::test;

namespace {

using Single = std::numeric_limits<float>;
using Full = std::numeric_limits<double>;

constexpr double most = Single::max();
constexpr double least = Single::min();

double above(double value)
{
    return std::nextafter(value, Full::infinity());
}

double below(double value)
{
    return std::nextafter(value, -Full::infinity());
}

/// NaN equal to NaN, and the zeros told apart.
template <typename T>
bool same(T a, T b)
{
    return std::isnan(a) ? std::isnan(b) : a == b && std::signbit(a) == std::signbit(b);
}

template <typename T>
std::string bytes_of(T value)
{
    std::uint64_t bits = 0;
    if constexpr (sizeof(T) == 4) {
        bits = std::bit_cast<std::uint32_t>(value);
    } else {
        bits = std::bit_cast<std::uint64_t>(value);
    }
    return number_bytes(static_cast<std::int64_t>(bits), sizeof(T));
}

/// What a Variable has of a label that has `from`.
template <typename To, typename From>
To read(From from)
{
    Mapping mapping{built_in_type_of<To>,
                    {sizeof(From) == 4 ? LabelType::Float : LabelType::Double}};
    return *mapping.read_of(bytes_of(from))->template get_if<To>();
}

template <typename To, typename From>
struct Row {
    From from;
    To to;
    bool is_refused{false};
};

template <typename To, typename From>
void check_write(const Row<To, From>& row)
{
    CAPTURE(row.from, row.to);
    Mapping mapping{built_in_type_of<From>,
                    {sizeof(To) == 4 ? LabelType::Float : LabelType::Double}};
    CHECK(mapping.write(Variant{row.from}) ==
          (row.is_refused ? status::Bad_OutOfRange : status::Good));
    if (!row.is_refused) {
        CHECK(mapping.bytes() == bytes_of(row.to));
    }
}

} // namespace

TEST_CASE("8.2 Floating point conversion: reading double precision to a Float", "[8.2]")
{
    const double infinity = Full::infinity();
    const std::array rows{
        Row<float, double>{infinity, Single::infinity()},
        Row<float, double>{Full::max(), Single::infinity()},
        Row<float, double>{above(most), Single::infinity()},
        Row<float, double>{most, Single::max()},
        Row<float, double>{0.1, 0.1F},
        Row<float, double>{least, Single::min()},
        Row<float, double>{below(least), 0.0F},
        Row<float, double>{Full::min(), 0.0F},
        Row<float, double>{below(Full::min()), 0.0F},
        Row<float, double>{Full::denorm_min(), 0.0F},
        Row<float, double>{0.0, 0.0F},
        Row<float, double>{-0.0, -0.0F},
        Row<float, double>{-Full::denorm_min(), -0.0F},
        Row<float, double>{above(-Full::min()), -0.0F},
        Row<float, double>{-Full::min(), -0.0F},
        Row<float, double>{above(-least), -0.0F},
        Row<float, double>{-least, -Single::min()},
        Row<float, double>{-0.1, -0.1F},
        Row<float, double>{-most, -Single::max()},
        Row<float, double>{below(-most), -Single::infinity()},
        Row<float, double>{-Full::max(), -Single::infinity()},
        Row<float, double>{-infinity, -Single::infinity()},
        Row<float, double>{Full::quiet_NaN(), Single::quiet_NaN()},
    };
    for (const auto& row : rows) {
        CAPTURE(row.from, row.to);
        CHECK(same(read<float>(row.from), row.to));
    }
}

TEST_CASE("8.2 Floating point conversion: reading single precision to a Double", "[8.2]")
{
    const float denormal = std::nextafter(Single::min(), 0.0F);
    const std::array rows{
        Row<double, float>{Single::infinity(), Full::infinity()},
        Row<double, float>{Single::max(), most},
        Row<double, float>{0.1F, double{0.1F}},
        Row<double, float>{Single::min(), least},
        Row<double, float>{denormal, 0.0},
        Row<double, float>{Single::denorm_min(), 0.0},
        Row<double, float>{0.0F, 0.0},
        Row<double, float>{-0.0F, -0.0},
        Row<double, float>{-Single::denorm_min(), -0.0},
        Row<double, float>{-denormal, -0.0},
        Row<double, float>{-Single::min(), -least},
        Row<double, float>{-Single::max(), -most},
        Row<double, float>{-Single::infinity(), -Full::infinity()},
        Row<double, float>{Single::quiet_NaN(), Full::quiet_NaN()},
    };
    for (const auto& row : rows) {
        CAPTURE(row.from, row.to);
        CHECK(same(read<double>(row.from), row.to));
    }
}

TEST_CASE("8.2 Floating point conversion: reading the Variable's own type", "[8.2]")
{
    for (const float value : {0.0F, -0.0F, Single::denorm_min(), -Single::infinity(),
                              Single::quiet_NaN(), Single::max(), 1.5F}) {
        CHECK(same(read<float>(value), value));
    }
    for (const double value :
         {0.0, -0.0, Full::denorm_min(), -Full::infinity(), Full::quiet_NaN(), Full::max(), 1.5}) {
        CHECK(same(read<double>(value), value));
    }
}

TEST_CASE("8.2 Floating point conversion: writing a Float to double precision", "[8.2]")
{
    const float denormal = std::nextafter(Single::min(), 0.0F);
    const std::array rows{
        Row<double, float>{Single::infinity(), 0, true},
        Row<double, float>{Single::max(), most},
        Row<double, float>{0.1F, double{0.1F}},
        Row<double, float>{Single::min(), least},
        Row<double, float>{denormal, 0.0},
        Row<double, float>{Single::denorm_min(), 0.0},
        Row<double, float>{0.0F, 0.0},
        Row<double, float>{-0.0F, 0, true},
        Row<double, float>{-Single::denorm_min(), 0, true},
        Row<double, float>{-denormal, 0, true},
        Row<double, float>{-Single::min(), -least},
        Row<double, float>{-Single::max(), -most},
        Row<double, float>{-Single::infinity(), 0, true},
        Row<double, float>{Single::quiet_NaN(), 0, true},
    };
    for (const auto& row : rows) {
        check_write(row);
    }
}

TEST_CASE("8.2 Floating point conversion: writing a Double to single precision", "[8.2]")
{
    const std::array rows{
        Row<float, double>{Full::infinity(), 0, true},
        Row<float, double>{Full::max(), 0, true},
        Row<float, double>{above(most), 0, true},
        Row<float, double>{most, Single::max()},
        Row<float, double>{0.1, 0.1F},
        Row<float, double>{least, Single::min()},
        Row<float, double>{below(least), 0.0F},
        Row<float, double>{Full::min(), 0.0F},
        Row<float, double>{below(Full::min()), 0.0F},
        Row<float, double>{Full::denorm_min(), 0.0F},
        Row<float, double>{0.0, 0.0F},
        Row<float, double>{-0.0, 0, true},
        Row<float, double>{-Full::denorm_min(), 0, true},
        Row<float, double>{-Full::min(), 0, true},
        Row<float, double>{above(-least), 0, true},
        Row<float, double>{-least, -Single::min()},
        Row<float, double>{-most, -Single::max()},
        Row<float, double>{below(-most), 0, true},
        Row<float, double>{-Full::max(), 0, true},
        Row<float, double>{-Full::infinity(), 0, true},
        Row<float, double>{Full::quiet_NaN(), 0, true},
    };
    for (const auto& row : rows) {
        check_write(row);
    }
}

TEST_CASE("8.2 Data types of labels: what note 1 keeps from a label of the same type", "[8.2]")
{
    const std::array singles{
        Row<float, float>{-0.0F, 0, true},
        Row<float, float>{Single::denorm_min(), 0, true},
        Row<float, float>{-Single::denorm_min(), 0, true},
        Row<float, float>{Single::quiet_NaN(), 0, true},
        Row<float, float>{Single::infinity(), 0, true},
        Row<float, float>{-Single::infinity(), 0, true},
        Row<float, float>{0.0F, 0.0F},
        Row<float, float>{Single::min(), Single::min()},
        Row<float, float>{-Single::max(), -Single::max()},
    };
    for (const auto& row : singles) {
        check_write(row);
    }
    const std::array doubles{
        Row<double, double>{-0.0, 0, true},
        Row<double, double>{Full::denorm_min(), 0, true},
        Row<double, double>{-Full::denorm_min(), 0, true},
        Row<double, double>{Full::quiet_NaN(), 0, true},
        Row<double, double>{Full::infinity(), 0, true},
        Row<double, double>{-Full::infinity(), 0, true},
        Row<double, double>{0.0, 0.0},
        Row<double, double>{Full::min(), Full::min()},
        Row<double, double>{-Full::max(), -Full::max()},
    };
    for (const auto& row : doubles) {
        check_write(row);
    }
}

} // namespace float_conversion_test
