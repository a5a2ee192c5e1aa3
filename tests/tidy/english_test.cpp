#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "english.hpp"

namespace english_test {

using namespace busbar;
using tidy::make_file;

namespace {

tidy::File read(const std::filesystem::path& path, const std::filesystem::path& root)
{
    std::ostringstream text;
    text << std::ifstream{path}.rdbuf();
    return make_file(std::filesystem::relative(path, root).generic_string(), text.str());
}

std::string text_of(const tidy::Findings& findings)
{
    std::string text;
    for (const std::string& finding : findings) {
        text += finding + "\n";
    }
    return text;
}

/// How often a header with this text has the phrase.
std::size_t count(const std::string& phrase, const std::string& text)
{
    tidy::PhraseCounts counts;
    counts.add(make_file("include/busbar/core/x.hpp", text));
    return counts.places[{"include", phrase}].size();
}

} // namespace

TEST_CASE("prose that has to be read twice becomes less", "[tidy]")
{
    const std::filesystem::path root{BUSBAR_SOURCE_DIR};
    tidy::PhraseCounts counts;
    for (const char* folder : {"lib", "include", "examples", "tests"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator{root / folder}) {
            if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp") {
                counts.add(read(entry.path(), root));
            }
        }
    }
    const auto ceilings = read(root / "tests/tidy/english.txt", root);
    CHECK(ceilings.lines.size() == counts.places.size());
    CHECK(text_of(tidy::check_phrases(counts, ceilings.lines)) == "");
}

TEST_CASE("doc comments that begin with a fragment are counted", "[tidy]")
{
    CHECK(count("fragment", "/// Of the scan.\nint x;\n") == 1);
    CHECK(count("fragment", "int x; ///< what is sent\nint y; ///< What is sent.\n") == 1);
    CHECK(count("fragment", "/// What is sent.\nint x;\n/// Who asks.\nint y;\n") == 2);
    CHECK(count("fragment", "/// Sends the values.\n/// Of these, the last is new.\n") == 0);
    CHECK(count("fragment", "// Of the scan.\n") == 0);
    CHECK(count("fragment", "/// From the wire.\nint x;\n/// From now on it waits.\n") == 1);
    CHECK(count("fragment", "/// Whatsoever.\n") == 0);
    CHECK(count("fragment", "const char* x = \"/// Of the scan.\";\n") == 0);
}

TEST_CASE("words of the dialect are counted in comments", "[tidy]")
{
    CHECK(count("behind", "// Behind the call, not behindhand.\n") == 1);
    CHECK(count("behind", "int behind = 0;\n") == 0);
    CHECK(count("nobody", "/// Whoever asks;\n/// nobody waits.\nint x; // who reads\n") == 3);
    CHECK(count("nobody", "/// A node whose value is new. A user who logs in.\n") == 0);
    CHECK(count("is-no", "// It is no name. They are no longer used, and "
                         "there is no file that is no older than it.\n") == 1);
    CHECK(count("is-no", "/// Is made\n/// anew.\n") == 1);
}

TEST_CASE("messages are counted apart from comments", "[tidy]")
{
    tidy::PhraseCounts counts;
    counts.add(make_file("lib/net/x.cpp", "#include \"who behind\"\n"
                                          "f(\"it is no \\\"file\", \"nobody\"); // is no file\n"));
    CHECK(counts.places[{"stack-messages", "is-no"}].size() == 1);
    CHECK(counts.places[{"stack-messages", "nobody"}].empty());
    CHECK(counts.places[{"stack-messages", "behind"}].empty());
    CHECK(counts.places[{"stack", "is-no"}].size() == 1);
    CHECK(tidy::prose_area("lib/product/x.cpp") == "controller");
    CHECK(tidy::prose_area("lib/backend/x.cpp") == "stack");
    CHECK(tidy::prose_area("tests/x/y.cpp") == "tests");
    CHECK(tidy::prose_area("examples/x/main.cpp") == "examples");
    CHECK(tidy::prose_area("tests/tidy/x.cpp").empty());
    CHECK(tidy::prose_area("fuzz/x.cpp").empty());
}

TEST_CASE("a ceiling holds counts down and falls with them", "[tidy]")
{
    tidy::PhraseCounts counts;
    counts.places[{"include", "behind"}] = {"a:1: x", "b:2: y"};
    CHECK(tidy::check_phrases(counts, {"include behind 2"}).empty());
    CHECK(tidy::check_phrases(counts, {"include behind 32"}).empty());
    CHECK(tidy::check_phrases(counts, {"include behind 33"}).size() == 1);
    CHECK(tidy::check_phrases(counts, {"include behind 1"}).size() == 3);
    CHECK(tidy::check_phrases(counts, {"stack behind 9"}).size() == 3);
}

} // namespace english_test
