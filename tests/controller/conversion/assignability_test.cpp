#include <catch2/catch.hpp>

#include <array>
#include <string_view>

#include "label_values.hpp"

namespace assignability_test {

using namespace busbar;
using namespace busbar::test;
using controller::Assignability;
using controller::assignability;
using controller::LeafType;

namespace {

constexpr std::array first_columns{
    LabelType::Bit,    LabelType::UnsignedWord, LabelType::UnsignedDoubleWord,
    LabelType::Word,   LabelType::DoubleWord,   LabelType::Float,
    LabelType::Double, LabelType::Time,
};
constexpr std::array second_columns{
    LabelType::String,         LabelType::UnicodeString, LabelType::Timer,
    LabelType::RetentiveTimer, LabelType::LongTimer,     LabelType::LongRetentiveTimer,
    LabelType::Counter,        LabelType::LongCounter,   LabelType::Pointer,
};
constexpr std::array parts{TimerPart::None, TimerPart::Contact, TimerPart::Coil,
                           TimerPart::Current};

// As the manual has them: '=' can be assigned, 'o' with a type conversion check. Of timers and
// counters '=' and 'o' are of the current value, 'b' of contact and coil.
struct Row {
    BuiltInType type;
    std::string_view first;
    std::string_view second;
};
constexpr std::array rows{
    Row{BuiltInType::Boolean, "=-------", "--bbbbbb-"},
    Row{BuiltInType::SByte, "-oooo---", "--oooooo-"},
    Row{BuiltInType::Byte, "-oooo---", "--oooooo-"},
    Row{BuiltInType::Int16, "-oo=o---", "--oooooo-"},
    Row{BuiltInType::UInt16, "-=ooo---", "--==oo=o-"},
    Row{BuiltInType::Int32, "-ooo=--=", "--oooooo-"},
    Row{BuiltInType::UInt32, "-o=oo---", "--oo==o=-"},
    Row{BuiltInType::Int64, "-oooo---", "--oooooo-"},
    Row{BuiltInType::UInt64, "-oooo---", "--oooooo-"},
    Row{BuiltInType::Float, "-----=o-", "---------"},
    Row{BuiltInType::Double, "-----o=-", "---------"},
    Row{BuiltInType::String, "--------", "oo-------"},
    Row{BuiltInType::DateTime, "--o-o---", "----oo-o-"},
    Row{BuiltInType::Guid, "--------", "---------"},
    Row{BuiltInType::ByteString, "--------", "---------"},
    Row{BuiltInType::XmlElement, "--------", "---------"},
    Row{BuiltInType::NodeId, "--------", "---------"},
    Row{BuiltInType::ExpandedNodeId, "--------", "---------"},
    Row{BuiltInType::StatusCode, "--------", "---------"},
    Row{BuiltInType::QualifiedName, "--------", "---------"},
    Row{BuiltInType::LocalizedText, "--------", "oo-------"},
    Row{BuiltInType::ExtensionObject, "--------", "---------"},
    Row{BuiltInType::DataValue, "--------", "---------"},
    Row{BuiltInType::Variant, "--------", "---------"},
    Row{BuiltInType::DiagnosticInfo, "--------", "---------"},
};

bool is_timer(LabelType type)
{
    return type >= LabelType::Timer && type <= LabelType::LongCounter;
}

Assignability expected(char cell, LabelType type, TimerPart part)
{
    const bool is_flag = part == TimerPart::Contact || part == TimerPart::Coil;
    if (is_timer(type) == (part == TimerPart::None) || is_flag != (cell == 'b' && is_timer(type))) {
        return Assignability::No;
    }
    return cell == '-'   ? Assignability::No
           : cell == 'o' ? Assignability::Checked
                         : Assignability::Same;
}

void check_cell(LeafType leaf, LabelType type, char cell)
{
    for (const TimerPart part : parts) {
        CAPTURE(name(leaf.built_in), static_cast<int>(type), static_cast<int>(part));
        const Assignability found = assignability(leaf, type, part);
        CHECK(static_cast<int>(found) == static_cast<int>(expected(cell, type, part)));
        const auto conversion = controller::LabelConversion::of(leaf, {type, part, 4});
        CHECK(conversion.has_value() == (found != Assignability::No));
    }
}

} // namespace

TEST_CASE("8.2 Data types of labels: each cell of the first table", "[8.2]")
{
    REQUIRE(rows.size() == last_built_in_type);
    for (const Row& row : rows) {
        for (std::size_t i = 0; i < first_columns.size(); ++i) {
            check_cell({row.type, false}, first_columns[i], row.first[i]);
        }
    }
}

TEST_CASE("8.2 Data types of labels: each cell of the second table", "[8.2]")
{
    for (const Row& row : rows) {
        for (std::size_t i = 0; i < second_columns.size(); ++i) {
            check_cell({row.type, false}, second_columns[i], row.second[i]);
        }
    }
}

TEST_CASE("8.2 Enumeration assignment: each row", "[8.2]")
{
    constexpr std::string_view first = "-ooo=---";
    for (std::size_t i = 0; i < first_columns.size(); ++i) {
        check_cell({BuiltInType::Int32, true}, first_columns[i], first[i]);
    }
    for (const LabelType type : second_columns) {
        check_cell({BuiltInType::Int32, true}, type, '-');
    }
}

TEST_CASE("8.2 Data types of labels: none of function blocks and structures", "[8.2]")
{
    for (const Row& row : rows) {
        check_cell({row.type, false}, LabelType::FunctionBlock, '-');
        check_cell({row.type, false}, LabelType::Structure, '-');
    }
    check_cell({BuiltInType::Null, false}, LabelType::Word, '-');
}

TEST_CASE("8.2 Method assignment: a Handle takes an unsigned word only", "[8.2]")
{
    for (int type = 0; type <= static_cast<int>(LabelType::Structure); ++type) {
        CHECK(controller::is_handle_label(static_cast<LabelType>(type)) ==
              (static_cast<LabelType>(type) == LabelType::UnsignedWord));
    }
}

} // namespace assignability_test
