#include <busbar/backend/slmp_device.hpp>

#include <catch2/catch.hpp>

#include <set>

namespace address_test {

using namespace busbar;
using namespace busbar::backend;

namespace {

constexpr SlmpNotation fx5{.is_octal = true, .has_long_form = false};
constexpr SlmpNotation hexadecimal_zr{.is_zr_hexadecimal = true};
constexpr SlmpNotation before_iqr{.has_long_form = false};

std::string refusal(std::string_view address, const SlmpNotation& notation = {})
{
    const auto parsed = parse_slmp_address(address, notation);
    return parsed ? "accepted" : text(parsed.error());
}

} // namespace

TEST_CASE("addresses of devices are read in the base of their device, and written in one way")
{
    struct Row {
        std::string_view text;
        std::string_view canonical;
        SlmpAddress address;
        SlmpNotation notation{};
    };
    const auto row = GENERATE(values<Row>({
        {"D100", "D100", {{0xA8, 100}}},
        {"d0100", "D100", {{0xA8, 100}}},
        {"X10", "X10", {{0x9C, 16}}},
        {"X10", "X10", {{0x9C, 8}}, fx5},
        {"y177", "Y177", {{0x9D, 127}}, fx5},
        {"M10", "M10", {{0x90, 10}}, fx5},
        {"X1f", "X1F", {{0x9C, 31}}},
        {"XF", "XF", {{0x9C, 15}}},
        {"DXF", "DXF", {{0xA2, 15}}},
        {"W1A", "W1A", {{0xB4, 26}}},
        {"WA", "WA", {{0xB4, 10}}},
        {"BB", "BB", {{0xA0, 11}}},
        {"SBB", "SBB", {{0xA1, 11}}},
        {"SD260", "SD260", {{0xA9, 260}}},
        {"ZR1535996", "ZR1535996", {{0xB0, 0x176FFC}}},
        {"ZR10", "ZR10", {{0xB0, 16}}, hexadecimal_zr},
        {"Z10", "Z10", {{0xCC, 10}}, hexadecimal_zr},
        {"LTN10", "LTN10", {{0x52, 10}}},
        {"LSTN0", "LSTN0", {{0x5A, 0}}},
        {"STN0", "STN0", {{0xC8, 0}}},
        {"CC3", "CC3", {{0xC3, 3}}},
        {"RD524286", "RD524286", {{0x2C, 524286}}},
        {"D4294967295", "D4294967295", {{0xA8, UINT32_MAX}}},
        {"D16777215", "D16777215", {{0xA8, 0xFFFFFF}}, before_iqr},
        {"D100.3", "D100.3", {{0xA8, 100}, 3}},
        {"D100.f", "D100.F", {{0xA8, 100}, 15}},
        {"W1.A", "W1.A", {{0xB4, 1}, 10}},
        {"U01\\G22", "U1\\G22", {{0xAB, 22, 1, 0xF8}}},
        {"u3e0\\hg0.0", "U3E0\\HG0.0", {{0x2E, 0, 0x3E0, 0xFA}, 0}},
        {"U3E0\\G10", "U3E0\\G10", {{0xAB, 10, 0x3E0, 0xFA}}},
        {"UFF\\G0", "UFF\\G0", {{0xAB, 0, 0xFF, 0xF8}}},
        {"J1\\W1A", "J1\\W1A", {{0xB4, 26, 1, 0xF9}}},
        {"J255\\SB0", "J255\\SB0", {{0xA1, 0, 255, 0xF9}}},
    }));
    INFO(row.text);
    const auto parsed = parse_slmp_address(row.text, row.notation);
    REQUIRE(parsed);
    CHECK(*parsed == row.address);
    CHECK(to_text(*parsed, row.notation) == row.canonical);
    CHECK(*parse_slmp_address(row.canonical, row.notation) == row.address);
}

TEST_CASE("what is no address of a device is refused with what was found and expected")
{
    CHECK(refusal("") == "column 1: found the end, expected a device, such as D, W, R, M, X or Y");
    CHECK(refusal("Q1") == "column 1: found 'Q1', expected a device, such as D, W, R, M, X or Y");
    CHECK(refusal("D") ==
          "column 2: found the end, expected decimal digits, since the numbers of D are decimal");
    CHECK(refusal("D1F") ==
          "column 3: found 'F', expected decimal digits, since the numbers of D are decimal");
    CHECK(refusal("D-1") ==
          "column 2: found '-1', expected decimal digits, since the numbers of D are decimal");
    CHECK(refusal("X1G") ==
          "column 3: found 'G', expected hexadecimal digits, since the numbers of "
          "X are hexadecimal");
    CHECK(refusal("X18", fx5) ==
          "column 3: found '8', expected octal digits, since the numbers of X are octal");
    CHECK(refusal("D 1").find("column 2: found ' 1'") == 0);
    CHECK(refusal("D1 ") == "column 3: found ' ', expected the end");
    CHECK(refusal("D4294967296") ==
          "column 2: found '4294967296', expected a number of up to 4294967295");
    CHECK(refusal("D16777216", before_iqr) ==
          "column 2: found '16777216', expected a number of up to 16777215");
    CHECK(refusal("X100000000", fx5).find("expected a number of up to 77777777") !=
          std::string::npos);
    CHECK(refusal("LTN1", before_iqr) ==
          "column 1: found 'LTN1', expected a device that a PLC before iQ-R has");
    CHECK(refusal("M1.0") ==
          "column 3: found '.0', expected the end: only words have bits, and M has none");
    CHECK(refusal("LTN1.0") == "column 5: found '.0', expected the end: only words have bits, and "
                               "LTN has more than one word");
    for (const auto bit : {"D1.", "D1.G", "D1.10", "D1.-1", "D1.0x"}) {
        CHECK(refusal(bit).find(", expected a bit, which is one hexadecimal digit, 0 to F") !=
              std::string::npos);
    }
    CHECK(refusal("G1") ==
          "column 1: found 'G1', expected U and the number of a module, as in U01\\G22");
    CHECK(refusal("U1\\D1") ==
          "column 4: found 'D1', expected G or HG, which are what a module has");
    CHECK(refusal("U1\\HG1") ==
          "column 4: found 'HG1', expected G, since only a CPU, U3E0 to U3E3, has HG");
    CHECK(refusal("J1\\D1") ==
          "column 4: found 'D1', expected a link device: X, Y, B, W, SB or SW");
    CHECK(refusal("J0\\W1") == "column 2: found '0\\W1', expected a network, J1 to J255");
    CHECK(refusal("U100\\G1") ==
          "column 2: found '100\\G1', expected a module, U0 to UFF, or a CPU, U3E0 to U3E3");
    CHECK(refusal("D1\\G1") ==
          "column 1: found 'D1\\G1', expected U and the number of a module, or "
          "J and that of a network, before \\");
    CHECK(refusal("U1.\\G1") == "column 3: found '.\\G1', expected \\ and a device");
    CHECK(refusal("\x1b[31mD1").find("\\x1B") != std::string::npos);
}

TEST_CASE("every kind of device has a name and a code of its own")
{
    std::set<std::string_view> names;
    std::set<std::uint16_t> codes;
    for (const SlmpDeviceType& type : slmp_device_types()) {
        INFO(type.name);
        CHECK(names.insert(type.name).second);
        CHECK(codes.insert(type.code).second);
        CHECK(find_slmp_device_type(type.code) == &type);
    }
    CHECK(names.size() == 40);
    CHECK(find_slmp_device_type(0) == nullptr);
    CHECK(to_text(SlmpAddress{{0x4F, 7}}) == "?4F:7");
}

} // namespace address_test
