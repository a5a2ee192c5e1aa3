#include <catch2/catch.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

/// The pages in Markdown against the files that they show and lead to.
namespace pages_test {

namespace {

using Lines = std::vector<std::string>;

const std::filesystem::path root{BUSBAR_SOURCE_DIR};

std::string trimmed(const std::string& line)
{
    const std::size_t first = line.find_first_not_of(' ');
    return first == std::string::npos ? "" : line.substr(first);
}

std::string text_of(const std::filesystem::path& path)
{
    std::ifstream file{path};
    return {std::istreambuf_iterator<char>{file}, {}};
}

/// The lines without indentation, and without those that are empty.
Lines lines_of(const std::string& text)
{
    Lines lines;
    std::istringstream stream{text};
    for (std::string line; std::getline(stream, line);) {
        if (line = trimmed(line); !line.empty()) {
            lines.push_back(line);
        }
    }
    return lines;
}

Lines read(const std::filesystem::path& path)
{
    return lines_of(text_of(path));
}

/// Every page of the repository, by its path from the root.
std::vector<std::string> pages()
{
    std::vector<std::string> found;
    for (const char* const folder :
         {"benchmarks", "examples", "fuzz", "include", "lib", "schemas", "tests"}) {
        for (auto entry = std::filesystem::recursive_directory_iterator{root / folder};
             entry != std::filesystem::recursive_directory_iterator{}; ++entry) {
            if (entry->path().filename() == "node_modules") {
                entry.disable_recursion_pending();
            } else if (entry->path().extension() == ".md") {
                found.push_back(entry->path().lexically_relative(root).string());
            }
        }
    }
    found.emplace_back("README.md");
    std::sort(found.begin(), found.end());
    return found;
}

/// A block of a page and the file that the comment before it names; none without such a comment.
struct Snippet {
    std::string language;
    std::optional<std::string> file;
    Lines lines;
};

std::vector<Snippet> snippets_of(const Lines& text)
{
    static const std::string open = "<!-- from ";
    std::vector<Snippet> snippets;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (!text[i].starts_with("```")) {
            continue;
        }
        Snippet snippet;
        snippet.language = text[i].substr(3);
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

/// Whether a CMakeLists.txt above the file names it, by its path from there.
bool is_built(const std::string& file)
{
    const std::filesystem::path path = root / file;
    for (auto folder = path.parent_path();; folder = folder.parent_path()) {
        const std::string list = text_of(folder / "CMakeLists.txt");
        if (list.find(path.lexically_relative(folder).string()) != std::string::npos) {
            return true;
        }
        if (folder == root) {
            return false;
        }
    }
}

/// What `[text](target)` leads to, without addresses of the web, places within the page and code.
std::vector<std::string> links_of(const std::string& page)
{
    static const std::regex block{"```[^`]*```"};
    static const std::regex link{R"(\]\(([^)\s]+)\))"};
    const std::string text = std::regex_replace(page, block, "");
    std::vector<std::string> targets;
    for (std::sregex_iterator i{text.begin(), text.end(), link}; i != std::sregex_iterator{}; ++i) {
        std::string target = (*i)[1].str();
        target.resize(std::min(target.find('#'), target.size()));
        if (!target.empty() && target.find("://") == std::string::npos) {
            targets.push_back(std::move(target));
        }
    }
    return targets;
}

/// The words of C++: letters, digits and underscores.
std::vector<std::string> words_of(const std::string& text)
{
    std::vector<std::string> words;
    std::string word;
    for (const char c : text + ' ') {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
            word += c;
        } else if (!word.empty()) {
            words.push_back(std::exchange(word, {}));
        }
    }
    return words;
}

} // namespace

TEST_CASE("code in a page stands in a file that is built", "[tidy]")
{
    std::size_t count = 0;
    for (const std::string& page : pages()) {
        for (const Snippet& snippet : snippets_of(read(root / page))) {
            INFO(page);
            REQUIRE_FALSE(snippet.lines.empty());
            INFO(snippet.lines.front());
            if (snippet.language == "cpp") {
                REQUIRE(snippet.file.has_value());
            }
            if (!snippet.file) {
                continue;
            }
            ++count;
            INFO(*snippet.file);
            CHECK(contains(read(root / *snippet.file), snippet.lines));
            // A header is compiled with what includes it.
            if (snippet.file->ends_with(".cpp")) {
                CHECK(is_built(*snippet.file));
            }
        }
    }
    CHECK(count >= 20);
}

TEST_CASE("links of a page lead to files that are there", "[tidy]")
{
    for (const std::string& page : pages()) {
        for (const std::string& target : links_of(text_of(root / page))) {
            INFO(page << ": " << target);
            CHECK(
                std::filesystem::exists(root / std::filesystem::path{page}.parent_path() / target));
        }
    }
}

TEST_CASE("README.md is short, and every guide can be reached from it", "[tidy]")
{
    CHECK(text_of(root / "README.md").size() <= 12'000);
    // From page to page, beginning with README.md.
    std::set<std::string> reached{"README.md"};
    std::vector<std::string> open{"README.md"};
    while (!open.empty()) {
        const std::filesystem::path page = open.back();
        open.pop_back();
        for (const std::string& target : links_of(text_of(root / page))) {
            const std::string path = (page.parent_path() / target).lexically_normal().string();
            if (path.ends_with(".md") && reached.insert(path).second) {
                open.push_back(path);
            }
        }
    }
    for (const std::string& page : pages()) {
        INFO(page);
        if (page.starts_with("examples/")) {
            CHECK(reached.contains(page));
        }
    }
}

TEST_CASE("lines of the unit in PRODUCTION.md stand in the unit of the package", "[tidy]")
{
    // Where cpack for Debian and the prefix /usr have them.
    std::string unit = text_of(root / "lib" / "packaging" / "busbar-controller.service.in");
    for (const auto& [name, value] : {std::pair{"@CMAKE_INSTALL_FULL_BINDIR@", "/usr/bin"},
                                      std::pair{"@BUSBAR_CONFIG_DIR@", "/etc/busbar"},
                                      std::pair{"@BUSBAR_STATE_DIR@", "/var/lib/busbar"}}) {
        unit = std::regex_replace(unit, std::regex{name}, value);
    }
    const Lines packaged = lines_of(unit);
    Lines shown;
    for (Snippet& snippet : snippets_of(read(root / "examples/controller/PRODUCTION.md"))) {
        if (snippet.language == "ini") {
            shown = std::move(snippet.lines);
        }
    }
    // In their order, so that each is in its section; all sections.
    auto place = packaged.begin();
    std::size_t sections = 0;
    for (const std::string& line : shown) {
        INFO(line);
        place = std::find(place, packaged.end(), line);
        REQUIRE(place != packaged.end());
        sections += line.starts_with('[') ? 1 : 0;
    }
    CHECK(sections == 3);
    CHECK(std::count_if(packaged.begin(), packaged.end(),
                        [](const std::string& line) { return line.starts_with('['); }) == 3);
}

TEST_CASE("calls in the table for users of open62541 are Busbar's", "[tidy]")
{
    std::set<std::string> known;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator{root / "include" / "busbar"}) {
        if (entry.path().extension() == ".hpp" || entry.path().extension() == ".h") {
            const auto words = words_of(text_of(entry.path()));
            known.insert(words.begin(), words.end());
        }
    }
    // The words in code of the second column.
    static const std::regex row{R"(\n\| [^|]*\| ([^|]*)\|)"};
    static const std::regex code{"`([^`]*)`"};
    const std::string page = text_of(root / "examples" / "FROM_OPEN62541.md");
    std::size_t count = 0;
    for (std::sregex_iterator i{page.begin(), page.end(), row}; i != std::sregex_iterator{}; ++i) {
        const std::string cell = (*i)[1].str();
        for (std::sregex_iterator c{cell.begin(), cell.end(), code}; c != std::sregex_iterator{};
             ++c) {
            for (const std::string& word : words_of((*c)[1].str())) {
                ++count;
                INFO(c->str() << ": " << word);
                CHECK(known.contains(word));
            }
        }
    }
    CHECK(count >= 40);
}

TEST_CASE("pages about formats have the versions and names of the code", "[tidy]")
{
    struct Agreement {
        const char* page;
        const char* says;
        const char* source;
        const char* has;
    };
    for (const Agreement& each : {
             Agreement{"lib/administration/FORMAT.md", "the only version is 1",
                       "lib/administration/setting_list.cpp", "settings_version = 1;"},
             Agreement{"lib/controller/backup/FORMAT.md", "## Layout, version 2",
                       "lib/controller/backup/backup_file.hpp", "backup_version = \"2\";"},
             Agreement{"lib/controller/logs/FORMAT.md", "`busbar execution log 1`",
                       "lib/controller/logs/execution_log_files.cpp", "busbar execution log 1"},
             Agreement{"lib/controller/project/FORMAT.md", "The only version is 1",
                       "include/busbar/controller/project.hpp", "project_version = 1;"},
             Agreement{"lib/controller/retained/FORMAT.md", "## The file `retained`, version 2",
                       "lib/controller/retained/retained_file.cpp", " version = 2;"},
             Agreement{"lib/controller/retained/FORMAT.md", "`retained.journal-2`, version 1",
                       "lib/controller/retained/retained_journal.cpp", "journal_version = 1;"},
             Agreement{"lib/harness/FORMAT.md", "busbar-recording 1",
                       "lib/harness/recording_text.cpp", "version = \"1\";"},
         }) {
        INFO(each.page << ": " << each.says);
        CHECK(text_of(root / each.page).find(each.says) != std::string::npos);
        CHECK(text_of(root / each.source).find(each.has) != std::string::npos);
    }
    std::set<std::string> known;
    for (const char* const folder : {"include", "lib", "examples"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator{root / folder}) {
            if (entry.is_regular_file() && entry.path().extension() != ".md") {
                const auto words = words_of(text_of(entry.path()));
                known.insert(words.begin(), words.end());
            }
        }
    }
    static const std::regex block{"```[^`]*```"};
    static const std::regex code{"`([^`]*)`"};
    for (const std::string& page : pages()) {
        if (!page.ends_with("FORMAT.md")) {
            continue;
        }
        const std::string text = std::regex_replace(text_of(root / page), block, "");
        for (std::sregex_iterator i{text.begin(), text.end(), code}; i != std::sregex_iterator{};
             ++i) {
            for (const std::string& word : words_of((*i)[1].str())) {
                INFO(page << ": " << i->str());
                CHECK((word.size() < 4 || known.contains(word)));
            }
        }
    }
}

TEST_CASE("pages are without words that stand for code or have to be read twice", "[tidy]")
{
    static const std::set<std::string> banned{"anew", "everybody", "nobody", "somebody", "whoever"};
    static const std::regex block{"```[^`]*```"};
    for (const std::string& page : pages()) {
        const auto words = words_of(std::regex_replace(text_of(root / page), block, ""));
        const auto count = std::count_if(words.begin(), words.end(), [](const std::string& word) {
            return banned.contains(word);
        });
        INFO(page);
        CHECK(count == 0);
    }
}

TEST_CASE("a snippet that differs from its file is found", "[tidy]")
{
    CHECK(contains({"a", "b", "c"}, {"b", "c"}));
    CHECK_FALSE(contains({"a", "b", "c"}, {"a", "c"}));
    const auto snippets = snippets_of({"<!-- from x.cpp -->", "```cpp", "int a;", "```", "```cpp",
                                       "int b;", "```", "```sh", "ls", "```"});
    REQUIRE(snippets.size() == 3);
    CHECK(snippets[0].file == "x.cpp");
    CHECK(snippets[0].lines == Lines{"int a;"});
    CHECK_FALSE(snippets[1].file.has_value());
    CHECK(snippets[2].language == "sh");
    CHECK(is_built("examples/first_server/main.cpp"));
    CHECK_FALSE(is_built("examples/first_server/other.cpp"));
    CHECK(links_of("[a](b.md#c) [d](https://e.example/f) [g](#h)") == Lines{"b.md"});
}

} // namespace pages_test
