#include "mapping_fixture.hpp"

namespace model_set_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

std::string mapped(const std::string& name, const std::string& label)
{
    return variable("s=" + name, extension("<DataMapping Data=\"" + label + "\"/>"));
}

/// A file of the namespace that needs another one for a reference.
std::string dependent(const std::string& uri, const std::string& on, const std::string& version)
{
    return file(uri,
                "<UAVariable NodeId=\"ns=1;s=D\" BrowseName=\"1:D\" DataType=\"i=6\"><References>"
                "<Reference ReferenceType=\"i=35\" IsForward=\"false\">ns=2;s=Cell</Reference>"
                "<Reference ReferenceType=\"i=40\">i=63</Reference></References></UAVariable>",
                required(on, version), "<Uri>" + on + "</Uri>");
}

/// The file with these attributes of its model instead of Version="1".
std::string of_version(std::string file, std::string_view attributes)
{
    constexpr std::string_view version = "Version=\"1\"";
    return file.replace(file.find(version), version.size(), attributes);
}

} // namespace

TEST_CASE("9.4 Import: what is mapped in the file and before", "[9.4]")
{
    ModelFixture project;
    project.import(file("urn:t", variable("s=Neither") + variable("s=Before") + variable("s=File") +
                                     variable("s=Both")));
    project.map("Before", "before");
    project.map("Both", "before");
    const ImportResult again =
        project.import(file("urn:t", variable("s=Neither") + variable("s=Before") +
                                         mapped("File", "file") + mapped("Both", "file")));
    CHECK(again.is_replacement);
    CHECK(again.node_count == 4);
    CHECK(again.reports.is_empty());
    CHECK(project.label("Neither").empty());
    CHECK(project.label("Before") == "before");
    CHECK(project.label("File") == "file");
    CHECK(project.label("Both") == "file");
}

TEST_CASE("9.4 Import: the mapping of a node that is gone goes", "[9.4]")
{
    ModelFixture project;
    project.import(file("urn:t", variable("s=A") + variable("s=B")));
    project.map("A", "a");
    project.map("B", "b");
    const ImportResult again = project.import(file("urn:t", variable("s=B")));
    CHECK(has(again.reports, ModelCode::MappingDropped));
    CHECK(project.models.mapping().variables.size() == 1);
    CHECK(project.label("B") == "b");
}

TEST_CASE("9.4 Import: another NodeClass", "[9.4]")
{
    ModelFixture project;
    project.import(file("urn:t", cell() + variable("s=N") + method("s=M")));
    project.map("N", "n");
    project.models.mapping().methods[project.id("M")].handle = "m";
    SECTION("a Variable keeps what its file says")
    {
        const auto result = project.import(file("urn:t", cell() + mapped("M", "new")));
        CHECK(project.label("M") == "new");
        CHECK(project.models.mapping().methods.empty());
        CHECK(has(result.reports, ModelCode::MappingDropped));
    }
    SECTION("any other loses its mapping, that of the file too")
    {
        const auto result = project.import(
            file("urn:t", cell() + method("s=N", extension("<MethodMapping><Handle Data=\"h\"/>"
                                                           "</MethodMapping>"))));
        CHECK(project.models.mapping() == Mapping{});
        CHECK(has(result.reports, ModelCode::MappingDropped));
    }
}

TEST_CASE("9.4 Import: other attributes keep the mapping and are a warning", "[9.4]")
{
    const std::vector<std::string> attributes{
        "DataType=\"i=11\"",
        "DataType=\"i=6\" ValueRank=\"1\"",
        "DataType=\"i=6\" ValueRank=\"1\" ArrayDimensions=\"3\"",
    };
    ModelFixture project;
    project.import(file("urn:t", variable("s=N")));
    project.map("N", "n");
    for (const std::string& each : attributes) {
        CAPTURE(each);
        const auto result = project.import(file("urn:t", variable("s=N", {}, each)));
        CHECK(has(result.reports, ModelCode::AttributesChanged));
        CHECK(result.reports.error_count() == 0);
        CHECK(project.label("N") == "n");
    }
    CHECK(project.import(file("urn:t", variable("s=N", {}, attributes.back()))).reports.is_empty());
}

TEST_CASE("9.4 Import: a RequiredModel must be there, of whatever version", "[9.4][9.6]")
{
    ModelFixture project;
    const ModelReports refused = project.refusal(dependent("urn:d", "urn:t", "1"));
    CHECK(has(refused, ModelCode::ModelMissing));
    project.import(file("urn:t", cell()));
    CHECK(project.import(dependent("urn:d", "urn:t", "1")).reports.is_empty());
    CHECK(project.models.namespaces().at(2).state == ModelState::Imported);
    const auto other = project.import(dependent("urn:d", "urn:t", "2"));
    CHECK(has(other.reports, ModelCode::ModelOfOtherVersion));
    CHECK(other.reports.error_count() == 0);
    const ModelNamespace& entry = project.models.namespaces().at(2);
    CHECK(entry.state == ModelState::OtherVersion);
    REQUIRE(entry.required.size() == 1);
    CHECK(entry.required.front() ==
          RequiredModelStatus{"urn:t", "2", "", ModelState::OtherVersion});
    // The namespace that is required in the version that is asked for.
    project.import(file("urn:t", cell(), {}, {}, "2"));
    CHECK(project.models.namespaces().at(2).state == ModelState::Imported);
}

TEST_CASE("9.6 Import status: an older RequiredModel by its date is a warning, too", "[9.6]")
{
    ModelFixture project;
    std::string old = file("urn:t", cell());
    const std::string version = "Version=\"1\"";
    old.insert(old.find(version), "PublicationDate=\"2020-01-01T00:00:00Z\" ");
    project.import(old);
    const std::string newer = "<RequiredModel ModelUri=\"urn:t\" "
                              "PublicationDate=\"2021-01-01T00:00:00Z\"/>";
    const auto result = project.import(file("urn:d", variable("s=A"), newer, "<Uri>urn:t</Uri>"));
    CHECK(has(result.reports, ModelCode::ModelOfOtherVersion));
    CHECK(project.models.namespaces().at(2).state == ModelState::OtherVersion);
}

TEST_CASE("9.6 Import status: a later RequiredModel is shown, and no warning", "[9.6]")
{
    struct Case {
        const char* asked;
        const char* there;
        ModelState state;
    };
    constexpr auto same = ModelState::Imported;
    constexpr auto later = ModelState::LaterVersion;
    constexpr auto other = ModelState::OtherVersion;
    constexpr const char* day_one = "PublicationDate=\"2024-01-01T00:00:00Z\"";
    const std::vector<Case> cases{
        // ModelVersion counts before PublicationDate (Part 6, F.2), Version only without both.
        {"Version=\"1.03\"", "Version=\"1.05.0\"", later},
        {"Version=\"1.10\"", "Version=\"1.9\"", other},
        {"Version=\"two\"", "Version=\"one\"", other},
        {"Version=\"1\"", day_one, same},
        {day_one, "Version=\"0\" PublicationDate=\"2025-01-01T00:00:00Z\"", later},
        {day_one, "PublicationDate=\"2024-01-01T01:00:00+01:00\"", same},
        {day_one, "PublicationDate=\"2023-12-31T23:59:59Z\"", other},
        {"PublicationDate=\"then\"", day_one, other},
        {"PublicationDate=\"2024-01-01T00:00:00Z\" ModelVersion=\"1.2.0\"",
         "PublicationDate=\"2023-01-01T00:00:00Z\" ModelVersion=\"1.10.0\"", later},
        {"PublicationDate=\"2023-01-01T00:00:00Z\" ModelVersion=\"1.2.0\"",
         "PublicationDate=\"2024-01-01T00:00:00Z\" ModelVersion=\"1.1.9\"", other},
        {"PublicationDate=\"2024-01-01T00:00:00Z\" ModelVersion=\"1.2\"",
         "PublicationDate=\"2023-01-01T00:00:00Z\" ModelVersion=\"1.2\"", other},
        {day_one, "PublicationDate=\"2023-01-01T00:00:00Z\" ModelVersion=\"1.0.0\"", later},
        {"PublicationDate=\"2023-01-01T00:00:00Z\" ModelVersion=\"1.0.0\"", day_one, other},
    };
    for (const Case& each : cases) {
        CAPTURE(each.asked, each.there);
        ModelFixture project;
        project.import(of_version(file("urn:t", cell()), each.there));
        const std::string asks =
            "<RequiredModel ModelUri=\"urn:t\" " + std::string{each.asked} + "/>";
        const auto result =
            project.import(file("urn:d", variable("s=A"), asks, "<Uri>urn:t</Uri>"));
        CHECK(has(result.reports, ModelCode::ModelOfOtherVersion) == (each.state == other));
        CHECK(project.models.namespaces().at(2).state == each.state);
    }
}

TEST_CASE("9.4 Import: one namespace for each file", "[9.4]")
{
    ModelFixture project;
    const std::string two =
        file("urn:t", variable("s=A") + "<UAObject NodeId=\"ns=2;s=B\" BrowseName=\"2:B\"/>", {},
             "<Uri>urn:u</Uri>");
    CHECK(has(project.refusal(two), ModelCode::SeveralNamespaces));
    CHECK(has(project.refusal(file("http://opcfoundation.org/UA/", {})), ModelCode::NoNamespace));
    CHECK(has(project.refusal("<UANodeSet/>"), ModelCode::NoNamespace));
    CHECK(has(project.refusal("no XML"), ModelCode::FileInvalid));
    const auto missing = project.models.import({"/nowhere/t.xml"});
    REQUIRE_FALSE(missing);
    CHECK(has(missing.error(), ModelCode::FileUnreadable));
}

TEST_CASE("9.4 Import: one that fails changes nothing", "[9.4]")
{
    ModelFixture project;
    project.import(file("urn:t", cell() + variable("s=A")));
    project.import(dependent("urn:d", "urn:t", "1"));
    project.map("A", "a");
    // Its type definition is nowhere.
    CHECK(has(project.refusal(file("urn:t", cell() + variable("s=A", {}, "DataType=\"ns=1;i=9\""))),
              ModelCode::FileInvalid));
    // The other file's node has lost its parent.
    CHECK(has(project.refusal(file("urn:t", variable("s=A"))), ModelCode::DependentInvalid));
    CHECK(project.label("A") == "a");
}

TEST_CASE("9.4 Import: a new model comes to what is loaded, as if all were loaded anew", "[9.4]")
{
    const std::string first = file("urn:t", cell() + mapped("A", "a"));
    const std::string second = dependent("urn:d", "urn:t", "1");
    ModelFixture in_turn;
    in_turn.import(first);
    in_turn.import(second);
    in_turn.map("A", "by hand");
    // One that fails after others leaves what it has begun.
    CHECK(has(in_turn.refusal(file("urn:x", variable("s=X", {}, "DataType=\"ns=1;i=9\""))),
              ModelCode::FileInvalid));
    CHECK(in_turn.label("A") == "by hand");
    in_turn.import(file("urn:y", cell() + mapped("Y", "y")));

    ModelFixture anew;
    anew.import(first);
    anew.import(second);
    anew.import(file("urn:y", cell() + mapped("Y", "y")));
    anew.import(first); // which loads all of them
    anew.map("A", "by hand");
    CHECK(in_turn.models.namespaces() == anew.models.namespaces());
    CHECK(in_turn.models.mapping() == anew.models.mapping());
    CHECK(in_turn.models.space().node_count() == anew.models.space().node_count());
    CHECK(in_turn.models.export_texts() == anew.models.export_texts());
}

TEST_CASE("9.4 Import: what is required must not come to stand last", "[9.4]")
{
    ModelFixture project;
    project.import(file("urn:t", cell()));
    project.import(file("urn:d", variable("s=A")));
    CHECK(has(project.refusal(file("urn:t", cell(), required("urn:d"), "<Uri>urn:d</Uri>")),
              ModelCode::ModelMissing));
}

TEST_CASE("2.1 Limits: files, bytes, namespaces, URIs and nodes", "[2.1]")
{
    const auto refused = [](const ModelLimits& limits, const std::string& text) {
        ModelFixture project{limits};
        return project.refusal(text);
    };
    ModelLimits limits = rd81opc96_model();
    limits.max_files = 0;
    CHECK(has(refused(limits, file("urn:t", cell())), ModelCode::TooManyFiles));
    limits = rd81opc96_model();
    limits.max_file_size = 100;
    CHECK(has(refused(limits, file("urn:t", cell())), ModelCode::FilesTooLarge));
    limits = rd81opc96_model();
    limits.max_namespaces = 1;
    CHECK(has(refused(limits, file("urn:t", cell(), {}, "<Uri>urn:u</Uri>")),
              ModelCode::TooManyNamespaces));
    limits = rd81opc96_model();
    CHECK(
        has(refused(limits, file("urn:" + std::string(131, 'x'), cell())), ModelCode::UriTooLong));
    limits.max_nodes = 1;
    CHECK(has(refused(limits, file("urn:t", cell() + variable("s=A"))), ModelCode::TooManyNodes));
    ModelFixture exact{rd81opc96_model()};
    exact.import(file("urn:" + std::string(130, 'x'), cell()));
}

TEST_CASE("9.6 Namespace: the list, and deleting its last one only", "[9.6]")
{
    ModelFixture project;
    project.import(file("urn:t", cell() + mapped("A", "a"), {}, {}, "1.2"));
    project.import(file("urn:u", mapped("B", "b")));
    const auto& list = project.models.namespaces();
    REQUIRE(list.size() == 3);
    CHECK(list[0].index == 0);
    CHECK(list[0].uri == "http://opcfoundation.org/UA/");
    CHECK(list[1] == ModelNamespace{1, "urn:t", "1.2", "", ModelState::Imported, {}});
    CHECK(list[2].index == 2);
    const auto code_of = [&](const std::string& uri) {
        const auto removed = project.models.remove(uri);
        REQUIRE_FALSE(removed);
        return removed.error().code;
    };
    CHECK(code_of("http://opcfoundation.org/UA/") == ModelCode::StandardNamespace);
    CHECK(code_of("urn:t") == ModelCode::NotUndermost);
    CHECK(code_of("urn:x") == ModelCode::NamespaceUnknown);
    CHECK(project.models.namespaces().size() == 3);
    REQUIRE(project.models.remove("urn:u"));
    CHECK(project.models.namespaces().size() == 2);
    CHECK_FALSE(project.models.space().namespace_index("urn:u"));
    CHECK(project.label("A") == "a");
    CHECK(project.models.mapping().variables.size() == 1);
    REQUIRE(project.models.remove("urn:t"));
    CHECK(project.models.mapping() == Mapping{});
}

TEST_CASE("9.4 Export: one namespace, which imports as the same", "[9.4]")
{
    ModelFixture project;
    project.import(file("urn:t", cell() + variable("s=A")));
    project.import(dependent("urn:d", "urn:t", "1"));
    project.map("A", "a");
    ModelFixture other;
    CHECK(other.import(project.exported("urn:t")).node_count == 2);
    CHECK(other.label("A") == "a");
    CHECK(other.import(project.exported("urn:d")).reports.is_empty());
    CHECK(other.exported("urn:t") == project.exported("urn:t"));
    CHECK(other.exported("urn:d") == project.exported("urn:d"));
    const std::vector<std::string> all{project.exported("urn:t"), project.exported("urn:d")};
    CHECK(project.models.export_texts() == all);
    const auto unknown = project.models.export_text("urn:x");
    REQUIRE_FALSE(unknown);
    CHECK(unknown.error().code == ModelCode::NamespaceUnknown);
}

TEST_CASE("9.4 Export: default names of files", "[9.4][A-6]")
{
    struct Row {
        std::string uri;
        std::vector<std::string> taken;
        std::string expected;
    };
    const std::vector<Row> rows{
        {"http://opcfoundation.org/UA", {}, "UA"},
        {"http://opcfoundation.org/UA/", {}, "_1"},
        {"urn:cell:line", {}, "urncellline"},
        {"http://a/b<c>:\"\\|?*d", {}, "bcd"},
        {"http://a/UA", {"UA"}, "UA_1"},
        {"http://a/UA", {"ua", "UA_1"}, "UA_2"},
        {"http://a/con", {}, "_1"},
        {"http://a/L?PT9", {}, "_1"},
        {"http://a/COM\u00B2", {"_1", "_2"}, "_3"},
        {"http://a/COM0", {}, "COM0"},
        {"http://a/?*", {}, "_1"},
        {"", {}, "_1"},
    };
    for (const Row& row : rows) {
        CAPTURE(row.uri);
        CHECK(default_file_name(row.uri, row.taken) == row.expected);
    }
}

TEST_CASE("9.4 Loading: into a server's AddressSpace, by whose NodeIds is mapped", "[9.4]")
{
    ModelFixture project;
    project.import(file("urn:t", mapped("A", "a")));
    model::AddressSpace space;
    REQUIRE(space.add_namespace("urn:server"));
    const auto mapping = project.models.load_into(space);
    REQUIRE(mapping);
    CHECK(mapping->variables.at(NodeId{2, "A"}).value.label == "a");
    const std::size_t nodes = space.node_count();
    const auto again = project.models.load_into(space);
    REQUIRE_FALSE(again);
    CHECK(space.node_count() == nodes);

    ModelSet with_application{{}, "urn:server"};
    REQUIRE(with_application.import({"t.xml", file("urn:t", mapped("A", "a"))}));
    CHECK(with_application.mapping().variables.count(NodeId{2, "A"}) == 1);
    const auto own = with_application.import({"t.xml", file("urn:server", cell())});
    REQUIRE_FALSE(own);
    CHECK(has(own.error(), ModelCode::StandardNamespace));
}

TEST_CASE("4.2 Output window: every code has a rule with all texts", "[4.2]")
{
    for (const ReportRule& rule : report_rules()) {
        CAPTURE(static_cast<int>(rule.code));
        CHECK(&rule_of(rule.code) == &rule);
        CHECK_FALSE(rule.function.empty());
        CHECK_FALSE(rule.category.empty());
        CHECK_FALSE(rule.content.empty());
        CHECK_FALSE(rule.corrective_action.empty());
        CHECK(rule.corrective_action.back() != '.');
    }
    ModelReports reports;
    for (std::size_t i = 0; i < ModelReports::max_kept + 5; ++i) {
        reports.add({ModelCode::ValueOmitted, {}, {}, {}});
    }
    reports.add({ModelCode::FileInvalid, {}, {}, {}});
    CHECK(reports.list().size() == ModelReports::max_kept);
    CHECK(reports.warning_count() == ModelReports::max_kept + 5);
    CHECK(reports.error_count() == 1);
}

TEST_CASE("2.1 Limits: the preset and the status bar", "[2.1][4.2]")
{
    const ModelLimits limits = rd81opc96_model();
    CHECK(limits.max_files == 10);
    CHECK(limits.max_file_size == 20'971'520);
    CHECK(limits.max_namespaces == 10);
    CHECK(limits.max_uri_length == 134);
    CHECK(limits.max_nodes == 50'000);
    CHECK(limits.max_variables == 25'000);
    CHECK(kilo_words(limits.max_variable_words) == 2'048);
    CHECK(limits.max_elements == 10'240);
    CHECK(limits.max_labels == 25'000);
    CHECK(limits.max_total_label_length == 2'500'000);
    ModelCounters counters{25'000, 2'500'000, 2'048 * 1'024, 25'000, 20'971'520};
    CHECK(status_bar(counters, limits) == StatusBar{});
    ++counters.label_length;
    ++counters.variables;
    ++counters.file_size;
    CHECK(status_bar(counters, limits) ==
          StatusBar{LimitState::DetailExceeded, LimitState::DetailExceeded, LimitState::Exceeded});
    ++counters.labels;
    ++counters.variable_words;
    CHECK(status_bar(counters, limits) ==
          StatusBar{LimitState::Exceeded, LimitState::Exceeded, LimitState::Exceeded});
    CHECK(status_bar(counters, {}) == StatusBar{});
    CHECK(kilo_words(1) == 1);
}

} // namespace model_set_test
