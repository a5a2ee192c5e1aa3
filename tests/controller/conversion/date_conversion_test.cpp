#include <catch2/catch.hpp>

#include "label_values.hpp"

namespace date_conversion_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::int64_t second_2000 = 946'684'800;   // 2000-01-01T00:00:00Z
constexpr std::int64_t second_2100 = 4'102'444'800; // 2100-01-01T00:00:00Z
constexpr std::int64_t second_2068 = 3'092'601'600; // 2068-01-01T00:00:00Z
constexpr LabelKind unsigned_label{LabelType::UnsignedDoubleWord};
constexpr LabelKind signed_label{LabelType::DoubleWord};

Variant date(std::int64_t unix_seconds, std::int64_t ticks = 0)
{
    return Variant{DateTime{DateTime::from_unix_seconds(unix_seconds).ticks + ticks}};
}

/// The seconds that a label has, or -1 if it was refused.
std::int64_t written(LabelKind label, const Variant& value, std::int32_t offset = 0)
{
    Mapping mapping{BuiltInType::DateTime, label, {offset}};
    const StatusCode status = mapping.write(value);
    if (status.is_bad()) {
        CHECK(status == status::Bad_OutOfRange);
        return -1;
    }
    return mapping.number();
}

} // namespace

TEST_CASE("8.2 DateTime conversion: from 2000 to 2099, signed to 2067", "[8.2]")
{
    for (const LabelKind& label :
         {unsigned_label, signed_label, LabelKind{LabelType::LongTimer, TimerPart::Current},
          LabelKind{LabelType::LongCounter, TimerPart::Current}}) {
        const std::int64_t end = label == signed_label ? second_2068 : second_2100;
        CHECK(written(label, date(second_2000)) == 0);
        CHECK(written(label, date(second_2000, -1)) == -1);
        CHECK(written(label, date(end - 1)) == end - 1 - second_2000);
        CHECK(written(label, date(end, -1)) == end - 1 - second_2000); // fractions are cut
        CHECK(written(label, date(end)) == -1);
        CHECK(written(label, Variant{DateTime{}}) == -1);
        CHECK(written(label, Variant{DateTime{INT64_MAX}}) == -1);
        CHECK(written(label, Variant{DateTime{INT64_MIN}}) == -1);
    }
}

TEST_CASE("8.2 DateTime conversion: seconds count by the PLC's clock", "[8.2]")
{
    constexpr std::int32_t japan = 9 * 60;
    CHECK(written(unsigned_label, date(second_2000 - 9 * 3600), japan) == 0);
    CHECK(written(unsigned_label, date(second_2000 - 9 * 3600 - 1), japan) == -1);
    CHECK(written(unsigned_label, date(second_2100 - 9 * 3600), japan) == -1);
    CHECK(written(signed_label, date(second_2000 + 5 * 3600 + 7), -5 * 60) == 7);
    Mapping mapping{BuiltInType::DateTime, unsigned_label, {japan}};
    CHECK(mapping.read_of(number_bytes(9 * 3600, 4)) == date(second_2000));
}

TEST_CASE("8.2 DateTime conversion: a Read takes what the label has", "[8.2]")
{
    Mapping mapping{BuiltInType::DateTime, unsigned_label};
    CHECK(mapping.read_of(number_bytes(UINT32_MAX, 4)) == date(second_2000 + UINT32_MAX));
    Mapping negative{BuiltInType::DateTime, signed_label};
    CHECK(negative.read_of(number_bytes(-60, 4)) == date(second_2000 - 60));
}

} // namespace date_conversion_test
