#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace readme_test {

namespace {

using Lines = std::vector<std::string>;

std::string trimmed(const std::string& line)
{
    const std::size_t first = line.find_first_not_of(' ');
    return first == std::string::npos ? "" : line.substr(first);
}

/// The lines without indentation, and without those that are empty.
Lines read(const std::filesystem::path& path)
{
    Lines lines;
    std::ifstream file{path};
    for (std::string line; std::getline(file, line);) {
        if (line = trimmed(line); !line.empty()) {
            lines.push_back(line);
        }
    }
    return lines;
}

/// A block of C++ and the file that the comment before it names; none if there is no such comment.
struct Snippet {
    std::optional<std::string> file;
    Lines lines;
};

std::vector<Snippet> snippets_of(const Lines& text)
{
    static const std::string open = "<!-- from ";
    std::vector<Snippet> snippets;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != "```cpp") {
            continue;
        }
        Snippet snippet;
        if (i > 0 && text[i - 1].starts_with(open)) {
            snippet.file = text[i - 1].substr(open.size(), text[i - 1].find(" -->") - open.size());
        }
        while (++i < text.size() && text[i] != "```") {
            snippet.lines.push_back(text[i]);
        }
        snippets.push_back(std::move(snippet));
    }
    return snippets;
}

bool contains(const Lines& file, const Lines& part)
{
    return std::search(file.begin(), file.end(), part.begin(), part.end()) != file.end();
}

} // namespace

TEST_CASE("C++ in the README stands in a file that is built", "[tidy]")
{
    const std::filesystem::path root{BUSBAR_SOURCE_DIR};
    const auto snippets = snippets_of(read(root / "README.md"));
    CHECK(snippets.size() >= 2);
    for (const Snippet& snippet : snippets) {
        REQUIRE_FALSE(snippet.lines.empty());
        INFO(snippet.lines.front());
        REQUIRE(snippet.file.has_value());
        INFO(*snippet.file);
        CHECK(contains(read(root / *snippet.file), snippet.lines));
    }
}

TEST_CASE("a snippet that differs from its file is found", "[tidy]")
{
    CHECK(contains({"a", "b", "c"}, {"b", "c"}));
    CHECK_FALSE(contains({"a", "b", "c"}, {"a", "c"}));
    const auto snippets = snippets_of({"<!-- from x.cpp -->", "```cpp", "int a;", "```", "```cpp",
                                       "int b;", "```", "```sh", "ls", "```"});
    REQUIRE(snippets.size() == 2);
    CHECK(snippets[0].file == "x.cpp");
    CHECK(snippets[0].lines == Lines{"int a;"});
    CHECK_FALSE(snippets[1].file.has_value());
}

} // namespace readme_test
