#include <catch2/catch.hpp>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/publishing.hpp>
#include <busbar/core/record.hpp>

#include "program_parts.hpp"

namespace publishing_records_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

std::string text_of(const Variant& value)
{
    if (const auto* text = value.get_if<String>()) {
        return text->str();
    }
    const auto* bits = value.get_if<std::uint16_t>();
    const auto* number = value.get_if<std::uint64_t>();
    return std::to_string(bits != nullptr ? *bits : number != nullptr ? *number : 999'999);
}

/// Records as "VariablePublished Name=Var1 Size=2 Values=1 Members=0".
class RecordLines final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view line) override
    {
        text += std::string{line} + "\n";
    }
    [[nodiscard]] bool wants(RecordKind) const override { return true; }
    void record(const Record& record) override
    {
        std::string line{name(record.kind)};
        for (const RecordField& field : record.fields) {
            line += " " + std::string{field.name} + "=" + text_of(field.value);
        }
        lines.push_back(line);
    }

    std::vector<std::string> lines;
    std::string text;
};

const TypeUse an_int = use(ElementaryType::Int);

} // namespace

TEST_CASE("Records of a start: each variable, then the totals (7-1-7)")
{
    Program program;
    program.types = {structure("Point", {an_int, an_int, an_int})};
    program.variables = {variable("Var1"), variable("Var2", use("Point")), variable("Var3"),
                         variable("Var4", array_of(an_int, {{0, 4}}))};
    const ProgramTypes types = ProgramTypes::create(program).value();
    RecordLines log;
    tell(log, Publication{types, nj501_publishing()});
    CHECK(log.lines ==
          std::vector<std::string>{"VariablePublished Name=Var1 Size=2 Values=1 Members=0",
                                   "VariablePublished Name=Var2 Size=6 Values=3 Members=3",
                                   "VariablePublished Name=Var3 Size=2 Values=1 Members=0",
                                   "VariablePublished Name=Var4 Size=10 Values=5 Members=0",
                                   "VariablesCounted Variables=4 Values=10 DataTypes=1"});
    CHECK(log.text == "4 variables are published, with 10 values and 1 structure definitions\n");
}

TEST_CASE("Records of what is not published, where it was found (7-1-6, 0100 and 0101)")
{
    PublishingLimits limits = nj501_publishing();
    limits.max_variables = 2;
    Program program{.variables = {variable("A\t", array_of(an_int, {{2, 5}})), variable("B"),
                                  variable("C", array_of(an_int, {{0, 512}})), variable("D"),
                                  variable("E")}};
    const ProgramTypes types = ProgramTypes::create(program).value();
    RecordLines log;
    Publication publication{types, limits};
    tell(log, publication);
    CHECK(log.lines ==
          std::vector<std::string>{
              "VariableNotPublished Name=A\t Reason=SubscriptOfArray Size=8 ErrorDetails=16",
              "VariablePublished Name=B Size=2 Values=1 Members=0",
              "VariableNotPublished Name=C Reason=MaxSize Size=1026 ErrorDetails=32",
              "VariablePublished Name=D Size=2 Values=1 Members=0",
              "PublishingLimitExceeded Limit=MaxVariables",
              "VariablesCounted Variables=2 Values=2 DataTypes=0"});
    CHECK(log.text.find("A\\x09 is not published: it is or has an array whose first index is "
                        "not 0 (8 bytes)\n") == 0);
    CHECK(publication.event_bits() == 48);
    CHECK(publication.event_bits(1) == 32);

    SECTION("added online: only the group is told, with all totals")
    {
        const Program edit{.variables = {variable("F")}};
        const ProgramTypes edit_types = ProgramTypes::create(edit).value();
        log.lines.clear();
        tell(log, publication, publication.add(edit_types));
        CHECK(log.lines ==
              std::vector<std::string>{"PublishingLimitExceeded Limit=MaxVariables",
                                       "VariablesCounted Variables=2 Values=2 DataTypes=0"});
    }
}

TEST_CASE("A variable that is left out of the program is not published, with its reason")
{
    Program program{.variables = {variable("A"), variable("T", use("TON")), variable("Z")}};
    const auto checked = CheckedProgram::create(std::move(program), Unserved::LeaveOut).value();
    RecordLines log;
    const Publication publication{checked->types()};
    tell(log, publication);
    CHECK(log.lines == std::vector<std::string>{
                           "VariablePublished Name=A Size=2 Values=1 Members=0",
                           "VariableNotPublished Name=T Reason=Unserved Size=0 ErrorDetails=256",
                           "VariablePublished Name=Z Size=2 Values=1 Members=0",
                           "VariablesCounted Variables=2 Values=2 DataTypes=0"});
    CHECK(log.text.find("T is not published: variables[1] (T): is of the type TON, which is not "
                        "declared\n") == 0);
    CHECK(publication.event_bits() == 256);
}

TEST_CASE("Each limit over all has its name (7-1-6, 0100)")
{
    CHECK(name(PublishingLimit::Variables) == "MaxVariables");
    CHECK(name(PublishingLimit::Values) == "MaxValues");
    CHECK(name(PublishingLimit::DataTypes) == "MaxDataTypes");
}

TEST_CASE("A variable added online has its own record (7-1-6, 0111)")
{
    const Program program{.variables = {variable("A")}};
    const ProgramTypes types = ProgramTypes::create(program).value();
    Publication publication{types};
    const Program edit{.variables = {variable("A"), variable("0")}};
    const ProgramTypes edit_types = ProgramTypes::create(edit).value();
    RecordLines log;
    tell(log, publication, publication.add(edit_types));
    CHECK(log.lines ==
          std::vector<std::string>{"VariablePublished Name=0 Size=2 Values=1 Members=0",
                                   "VariablesCounted Variables=2 Values=2 DataTypes=0"});
}

} // namespace publishing_records_test
