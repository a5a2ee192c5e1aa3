#include <catch2/catch.hpp>

#include <fstream>
#include <string>
#include <vector>

#include <busbar/controller/program_files.hpp>
#include <busbar/controller/program_text.hpp>
#include <busbar/core/status_codes.hpp>

#include "shown_program.hpp"
#include "support/temporary_folder.hpp"

// Programs that are in several files.

namespace program_files_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

constexpr std::size_t enough = 1U << 20U;

struct Folder : busbar::test::TemporaryFolder {
    /// Writes a file below the folder.
    void write(const std::string& name, const std::string& text) const
    {
        std::filesystem::create_directories((path / name).parent_path());
        std::ofstream{path / name, std::ios::binary} << text;
    }
    [[nodiscard]] std::string at(const std::string& name) const { return (path / name).string(); }
    /// Shows the program at this path, with the folder's name as "~".
    [[nodiscard]] std::string shown(const std::string& paths,
                                    Unserved unserved = Unserved::LeaveOut) const
    {
        const auto text = read_program_files(paths, enough);
        if (!text) {
            return without_folder(busbar::text(text.error()));
        }
        return without_folder(
            controller::test::shown(read_program_text(*text, "all", {}, unserved)));
    }
    [[nodiscard]] std::string without_folder(std::string text) const
    {
        const std::string folder = path.string();
        for (std::size_t at = text.find(folder); at != text.npos; at = text.find(folder)) {
            text.replace(at, folder.size(), "~");
        }
        return text;
    }
};

std::string object(const std::string& kind, const std::string& name, const std::string& text)
{
    return "<TcPlcObject><" + kind + " Name=\"" + name + "\"><Declaration><![CDATA[" + text +
           "]]></Declaration></" + kind + "></TcPlcObject>";
}

std::string list_of(const std::vector<std::string>& files)
{
    std::string text = "<Project xmlns=\"http://schemas.microsoft.com/developer/msbuild/2003\">"
                       "<ItemGroup>";
    for (const std::string& file : files) {
        text += "<Compile Include=\"" + file + "\"/>";
    }
    return text + "</ItemGroup></Project>";
}

} // namespace

TEST_CASE_METHOD(Folder, "The files of a folder are one program, whatever their formats are")
{
    write("types.st", "TYPE B EXTENDS A : STRUCT y : ARRAY [0..N] OF INT; END_STRUCT END_TYPE");
    write("deep/base.TcDUT", object("DUT", "A", "TYPE A : STRUCT x : BOOL; END_STRUCT END_TYPE"));
    write("deep/line.xml", "<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><instances>"
                           "<configurations><configuration name=\"C\"><globalVars><variable "
                           "name=\"v\"><type><derived name=\"B\"/></type></variable></globalVars>"
                           "</configuration></configurations></instances></project>");
    write("gvl.st", "VAR_GLOBAL CONSTANT N : INT := 2; END_VAR");
    write(".hidden.st", "VAR_GLOBAL no : INT; END_VAR");
    write("README.md", "no program");
    CHECK(shown(path.string()) == "v (x BOOL, y [0..2]INT); N INT");
    CHECK(shown(at("gvl.st")) == "N INT");
    // A file that is named twice is read once.
    CHECK(shown(at("gvl.st") + "\n" + path.string() + "\n" + at("deep/base.TcDUT")) ==
          "N INT; v (x BOOL, y [0..2]INT)");
    CHECK(shown(at("deep/line.xml") + "\n" + at("types.st")) ==
          "- B found 'N', which is neither a constant nor a value of an enumeration that is "
          "declared here; - v is of the type B, which is left out");
}

TEST_CASE_METHOD(Folder, "Problems have the name of the file that they are in")
{
    write("a.st", "VAR_GLOBAL\n a : INT;\n t : TON;\nEND_VAR");
    write("b.st", "VAR_GLOBAL\n a : DINT;\n b : INT := 1 +;\nEND_VAR");
    write("c.xml", "<project");
    write("d.st", "PK\x03\x04");
    const auto text = read_program_files(path.string(), enough);
    REQUIRE(text);
    auto program = read_program_text(*text, "all", {}, Unserved::LeaveOut);
    REQUIRE(program);
    CHECK(program->files.size() == 4);
    const auto checked = CheckedProgram::create(*std::move(program), Unserved::LeaveOut);
    REQUIRE(checked);
    std::string all;
    for (const LeftOut& each : (*checked)->program().left_out) {
        all += without_folder(busbar::text(each.problem)).substr(0, 52) + "\n";
    }
    CHECK(all == "c.xml:1:8: is not well-formed XML: Error parsing sta\n"
                 "d.st:1:1: found a ZIP archive, such as a project or \n"
                 "b.st:3:16: variable b: found ';', expected a value\n"
                 "a.st:3:2: variables[1] (t): is of the type TON, whic\n"
                 "b.st:2:2: variables[2] (a): is also the name of anot\n");
    CHECK(shown(path.string(), Unserved::Refuse).starts_with("c.xml:1:8: is not well-formed"));
}

TEST_CASE_METHOD(Folder, "A .plcproj names the files of a program")
{
    write("GVLs/GVL 1.TcGVL", object("GVL", "GVL", "VAR_GLOBAL a : INT; END_VAR"));
    write("GVLs/Other.TcGVL", object("GVL", "Other", "VAR_GLOBAL b : INT; END_VAR"));
    write("Task.TcTTO", "<TcPlcObject><Task Name=\"T\"/></TcPlcObject>");
    write("p.plcproj", list_of({"gvls\\GVL%201.tcgvl", ".\\GVLs\\GVL 1.TcGVL", "Task.TcTTO"}));
    CHECK(shown(path.string()) == "a INT");
    CHECK(shown(at("p.plcproj")) == "a INT");
    write("q.plcproj", list_of({"GVLs\\Other.TcGVL"}));
    CHECK(shown(path.string()) == "~: has 2 .plcproj; expected the path of one of them");
    CHECK(shown(at("q.plcproj") + "\n" + at("p.plcproj")) == "b INT; a INT");
    write("q.plcproj", "<Project><ItemGroup>");
    CHECK(shown(at("q.plcproj")).starts_with("~/q.plcproj: is not well-formed XML"));
}

TEST_CASE_METHOD(Folder, "A .plcproj that compiles no file with declarations is refused")
{
    write("a.TcGVL", object("GVL", "A", "VAR_GLOBAL a : INT; END_VAR"));
    const std::string refusal = "~/p.plcproj: compiles no file with declarations; expected .TcGVL, "
                                ".TcDUT, .TcPOU or .TcIO in its <Compile Include>";
    const std::string list = GENERATE(
        std::string{"<Project><ItemGroup/></Project>"}, std::string{"<Project/>"},
        list_of({"Task.TcTTO", "View.TcVIS", "", "a.TcGVL.bak"}),
        std::string{"<Project><ItemGroup><Compile Include=\"a.TcGVL\"><ExcludeFromBuild>true"
                    "</ExcludeFromBuild></Compile></ItemGroup></Project>"},
        std::string{"<Project><ItemGroup><None Include=\"a.TcGVL\"/></ItemGroup></Project>"});
    CAPTURE(list);
    write("p.plcproj", list);
    CHECK(shown(at("p.plcproj")) == refusal);
    CHECK(shown(path.string()) == refusal);
    CHECK(shown(at("a.TcGVL") + "\n" + at("p.plcproj")) == refusal);
    // One that is missing is told as such.
    write("p.plcproj", list_of({"none.TcGVL"}));
    CHECK(shown(at("p.plcproj")) == "none.TcGVL: the file is missing");
}

TEST_CASE_METHOD(Folder, "A .plcproj of more than 4 MiB is refused before it is parsed")
{
    constexpr std::size_t most = 4U << 20U;
    write("a.TcGVL", object("GVL", "A", "VAR_GLOBAL a : INT; END_VAR"));
    std::string list = list_of({"a.TcGVL"});
    list.resize(most, '\n');
    write("p.plcproj", list);
    CHECK(read_program_files(at("p.plcproj"), 2 * most));
    write("p.plcproj", list + '<'); // is not well-formed either
    const auto large = read_program_files(at("p.plcproj"), 2 * most);
    REQUIRE_FALSE(large);
    CHECK(large.error().status == status::Bad_EncodingLimitsExceeded);
    CHECK(without_folder(busbar::text(large.error())) ==
          "~/p.plcproj: found more than 4194304 bytes of a list of files (.plcproj) "
          "(Bad_EncodingLimitsExceeded)");
}

TEST_CASE_METHOD(Folder, "A .plcproj has no files outside of its folder")
{
    write("out.TcGVL", object("GVL", "Out", "VAR_GLOBAL out : INT; END_VAR"));
    write("in/a.TcGVL", object("GVL", "A", "VAR_GLOBAL a : INT; END_VAR"));
    std::filesystem::create_symlink(at("out.TcGVL"), at("in/link.TcGVL"));
    std::filesystem::create_symlink(at("in"), at("in/loop"));
    const std::string named = GENERATE("..\\out.TcGVL", "a\\..\\..\\out.TcGVL", "C:\\out.TcGVL",
                                       "/etc/out.TcGVL", "link.TcGVL", "none.TcGVL");
    CAPTURE(named);
    write("in/p.plcproj", list_of({"a.TcGVL", named}));
    const std::string read = shown(at("in/p.plcproj"));
    CHECK(read.starts_with("a INT; - "));
    // The name tells a missing file from another one.
    CHECK(read.find("; -  ") == read.npos);
    CHECK(read.find("out INT") == read.npos);
    CHECK_FALSE(shown(at("in/p.plcproj"), Unserved::Refuse).starts_with("a INT"));
    // A folder does not lead through links to folders either, nor out of itself.
    std::filesystem::remove(at("in/p.plcproj"));
    CHECK(shown(at("in")) == "a INT; - link.TcGVL is a link to a file outside of the folder");
}

TEST_CASE_METHOD(Folder, "The files of a program have limits")
{
    write("a.st", "VAR_GLOBAL a : INT; END_VAR");
    write("b.st", "VAR_GLOBAL b : INT; END_VAR");
    const auto large = read_program_files(path.string(), 100);
    REQUIRE_FALSE(large);
    CHECK(large.error().status == status::Bad_EncodingLimitsExceeded);
    const auto missing = read_program_files(at("a.st") + "\n" + at("c.st"), enough);
    REQUIRE_FALSE(missing);
    CHECK(missing.error().status == status::Bad_NotFound);
    write("p/p.plcproj", list_of({"..\\" + std::string(5'000, 'n') + ".TcGVL"}));
    CHECK(shown(at("p")).find("is a name of more than 4096 bytes") != std::string::npos);
    std::filesystem::create_directory(at("empty"));
    CHECK(shown(at("empty")).starts_with("~/empty: found no file of a program in the folder"));
}

TEST_CASE_METHOD(Folder, "The same folder elsewhere is the same program")
{
    write("a/GVLs/x.TcGVL", object("GVL", "A", "VAR_GLOBAL a : INT; END_VAR"));
    write("a/types.st", "VAR_GLOBAL b : TON; END_VAR");
    std::filesystem::create_directory(at("deep"));
    std::filesystem::copy(at("a"), at("deep/b"), std::filesystem::copy_options::recursive);
    const auto same = [&](const std::string& name) {
        const auto first = read_program_files(at("a") + name, enough);
        const auto second = read_program_files(at("deep/b") + name, enough);
        return first && second && *first == *second;
    };
    CHECK(same(""));
    CHECK(same("/"));
    write("a/p.plcproj", list_of({"gvls\\X.TcGVL", "none.TcGVL"}));
    write("deep/b/p.plcproj", list_of({"gvls\\X.TcGVL", "none.TcGVL"}));
    CHECK(same("/p.plcproj"));
    // A list is one under any name.
    std::filesystem::copy_file(at("a/p.plcproj"), at("a/list.xml"));
    CHECK(read_program_files(at("a/list.xml"), enough).value() ==
          read_program_files(at("a/p.plcproj"), enough).value());
    CHECK(is_program_list(at("a/list.xml")));
    CHECK(is_program_list(at("a/none.plcproj")));
    CHECK_FALSE(is_program_list(at("a/types.st")));
    CHECK_FALSE(is_program_list(at("a")));
    // Files of one name in two folders are told apart.
    const auto both = read_program_files(at("a/types.st") + "\n" + at("deep/b/types.st"), enough);
    REQUIRE(both);
    const auto program = read_program_text(*both, "all", {}, Unserved::LeaveOut);
    REQUIRE(program);
    CHECK(program->files == std::vector<std::string>{"types.st", at("deep/b/types.st")});
}

TEST_CASE("A damaged text of several files is refused")
{
    busbar::test::TemporaryFolder folder;
    std::ofstream{folder.path / "a.st"} << "VAR_GLOBAL a : INT; END_VAR";
    std::ofstream{folder.path / "b.st"} << "VAR_GLOBAL b : INT; END_VAR";
    const auto text = read_program_files(folder.path.string(), enough);
    REQUIRE(text);
    REQUIRE(read_program_text(*text, "all"));
    std::size_t refused = 0;
    for (std::size_t end = 1; end < text->size(); ++end) {
        refused += read_program_text(text->substr(0, end), "all") ? 0 : 1;
    }
    // Only the empty one and that of the first file are whole.
    CHECK(refused == text->size() - 3);
    const auto one = read_program_files((folder.path / "a.st").string(), enough);
    REQUIRE(one);
    CHECK(*one == "VAR_GLOBAL a : INT; END_VAR");
}

TEST_CASE("A text of several files has limits of names, and of what is said of missing ones")
{
    const auto entry = [](const std::string& kind, std::size_t name, const std::string& text) {
        return kind + " " + std::to_string(text.size()) + " " + std::string(name, 'n') + "\n" +
               text + "\n";
    };
    const std::string begin = "%busbar program of several files, 1\n";
    const auto bundle = [&](const std::string& kind, std::size_t name, const std::string& text) {
        return begin + entry(kind, name, text);
    };
    const auto read = [](const std::string& text) {
        return read_program_text(text, "all", {}, Unserved::LeaveOut);
    };
    const std::string file = "VAR_GLOBAL a : INT; END_VAR";
    CHECK(read(bundle("file", 4'096, file)));
    const auto missing =
        read(bundle("file", 1, file) + entry("missing", 4'096, std::string(1'024, 'w')));
    REQUIRE(missing);
    REQUIRE(missing->left_out.size() == 1);
    CHECK(missing->left_out[0].problem.text.size() == 259); // 256 bytes and three points
    for (const std::string& text : {bundle("file", 4'097, file), bundle("missing", 4'097, "why"),
                                    bundle("missing", 1, std::string(1'025, 'w'))}) {
        const auto refused = read(text);
        REQUIRE_FALSE(refused);
        CHECK(busbar::text(refused.error()) ==
              "all: has too long a text for file 1 of it; expected a name of at most 4096 bytes, "
              "and at most 1024 about a missing file");
    }
}

TEST_CASE_METHOD(Folder, "A file that is left out has its name, so that another one is another")
{
    write("a.TcGVL", object("GVL", "A", "VAR_GLOBAL a : INT; END_VAR"));
    write("zip.TcGVL", "PK\x03\x04");
    write("p.plcproj", list_of({"a.TcGVL", "b.TcGVL", "zip.TcGVL"}));
    const auto text = read_program_files(at("p.plcproj"), enough);
    REQUIRE(text);
    const auto program = read_program_text(*text, "all", {}, Unserved::LeaveOut);
    REQUIRE(program);
    REQUIRE(program->left_out.size() == 2);
    CHECK(program->left_out[0].declared.name == "b.TcGVL");
    CHECK(program->left_out[0].problem.text == "the file is missing");
    CHECK(program->left_out[1].declared.name == "zip.TcGVL");
}

} // namespace program_files_test
