#include <busbar/controller/label_check.hpp>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/simulated_labels.hpp>

#include "mapping_fixture.hpp"

namespace label_check_test {

using namespace busbar;
using namespace busbar::controller;

// SH-082679, 8.2 and 8.3: the labels of a project and those of a PLC, before a server asks it.

namespace {

const std::string declarations = "{attribute 'publish' := 'publish only'} VAR_GLOBAL\n"
                                 "Num : INT; Long : DINT; Text : STRING[8]; Wide : LREAL;\n"
                                 "Delay : TIMER; Row : ARRAY[0..1] OF INT; Start : WORD;\n"
                                 "END_VAR VAR_GLOBAL Secret : INT; END_VAR\n"
                                 "VAR_GLOBAL CONSTANT Fixed : INT := 1; END_VAR";

struct Fixture : ModelFixture {
    Fixture()
    {
        auto read = read_declarations(declarations, "line.st");
        REQUIRE(read);
        program = *std::move(read);
        import(file("urn:t", cell() + variable("s=I16", {}, "DataType=\"i=4\"") +
                                 variable("s=I8", {}, "DataType=\"i=2\"") +
                                 variable("s=B", {}, "DataType=\"i=1\"") + method("s=M")));
    }
    /// What differs where the Variable has this label: "" for nothing.
    [[nodiscard]] std::string difference(const std::string& variable, const std::string& label)
    {
        models.mapping().variables.clear();
        map(variable, label);
        const auto plc = SimulatedLabels::create(program);
        REQUIRE(plc);
        const auto found = compare_labels(models, **plc);
        REQUIRE(found);
        REQUIRE(found->size() < 2);
        return found->empty() ? "" : text(found->front());
    }

    Program program;
};

/// A PLC that has to be asked.
struct FarPlc final : backend::LabelBackend {
    void start(std::unique_ptr<backend::LabelRequest>) override {}
    void attach(backend::LabelListener*) override {}
};

} // namespace

TEST_CASE_METHOD(Fixture, "Labels of a PLC: node, label, expected and found type are told", "[8.2]")
{
    CHECK(difference("I16", "Num").empty());
    CHECK(difference("I16", "Text") == "Text of ns=1;s=I16: found STRING(8), expected INT");
    CHECK(difference("I16", "Long").find("found DINT, expected INT") != std::string::npos);
    CHECK(difference("B", "Num").find("found INT, expected BOOL; any timer") != std::string::npos);
    // No label has exactly its values.
    CHECK(difference("I8", "Num").empty());
    CHECK(difference("B", "Delay.S").empty());
    CHECK(difference("B", "Delay.N").find("found TIMER .N") != std::string::npos);
}

TEST_CASE_METHOD(Fixture, "Labels of a PLC: why one cannot be used", "[8.3]")
{
    const auto reason = [&](const std::string& label) { return difference("I16", label); };
    CHECK(reason("None").find("the PLC has no label of this name, expected INT") !=
          std::string::npos);
    CHECK(reason("Secret").find("the PLC does not publish it") != std::string::npos);
    CHECK(reason("Fixed").find("it is CONSTANT in the PLC") != std::string::npos);
    CHECK(reason("Row").find("it is an array, a structure or a bit as a whole") !=
          std::string::npos);
    CHECK(reason("Row[1]").empty());
    CHECK(reason("Row[2]").find("the PLC has no label of this name") != std::string::npos);
}

TEST_CASE_METHOD(Fixture, "Labels of a PLC: of a Handle, and as reports", "[8.3]")
{
    models.mapping().methods[id("M")].handle = "Start";
    map("I16", "Long");
    auto reports = check_labels(models, program);
    REQUIRE(reports);
    CHECK(reports->error_count() == 0);
    REQUIRE(reports->warning_count() == 1);
    CHECK(reports->list().front().code == ModelCode::LabelConverted);
    CHECK(reports->list().front().where == "ns=1;s=I16");
    models.mapping().methods[id("M")].handle = "Long";
    map("I16", "None");
    reports = check_labels(models, program);
    REQUIRE(reports);
    CHECK(has(*reports, ModelCode::LabelUnavailable));
    CHECK(has(*reports, ModelCode::LabelOfWrongType));
    CHECK(lines(*reports).find("ns=1;s=M: Handle: ") != std::string::npos);
}

TEST_CASE("A label of UTF-16 is told as both declarations that it can have", "[8.2]")
{
    CHECK(declaration_of({backend::LabelType::UnicodeString, backend::TimerPart::None, 8}) ==
          "WSTRING(8), ARRAY[0..8] OF UTF16_UNIT");
}

TEST_CASE_METHOD(Fixture, "Labels of a PLC: one that has to be asked is not compared", "[8.3]")
{
    map("I16", "Num");
    CHECK_FALSE(compare_labels(models, FarPlc{}));
}

} // namespace label_check_test
