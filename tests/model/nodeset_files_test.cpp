#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

#include <model/nodeset/document.hpp>

#include "nodeset_fixture.hpp"

// NodeSet2 files that are not part of the repository: those of the folders in the environment
// variable BUSBAR_NODESETS, separated by colons.

namespace busbar::model::nodeset_files_test {

namespace {

namespace fs = std::filesystem;

std::vector<NodeSetSource> published_files()
{
    std::vector<NodeSetSource> files;
    const char* const variable = std::getenv("BUSBAR_NODESETS");
    std::string folders = variable == nullptr ? "" : variable;
    while (!folders.empty()) {
        const std::string folder = folders.substr(0, folders.find(':'));
        folders.erase(0, std::min(folder.size() + 1, folders.size()));
        std::error_code ignored;
        for (const auto& entry : fs::directory_iterator{folder, ignored}) {
            if (entry.path().extension() == ".xml") {
                files.push_back({entry.path().string(), {}, true});
            }
        }
    }
    return files;
}

constexpr const char* opc_ua = "http://opcfoundation.org/UA/";

/// The files by the URIs of their models, and what these require.
class Library {
public:
    explicit Library(const std::vector<NodeSetSource>& files)
    {
        for (const NodeSetSource& file : files) {
            nodeset::Document document;
            REQUIRE(document.load_file(file.name).empty());
            for (const NodeSetModel& model : document.models()) {
                files_[model.uri] = file.name;
                for (const NodeSetModel& required : model.required) {
                    required_[file.name].insert(required.uri);
                }
            }
        }
        files_.erase(opc_ua); // which every AddressSpace has
    }

    [[nodiscard]] const std::map<std::string, std::string>& files() const { return files_; }

    /// The file of a model and those that it requires, which may require others.
    [[nodiscard]] std::set<std::string> with_required(const std::string& uri) const
    {
        std::set<std::string> result;
        std::vector<std::string> open{uri};
        while (!open.empty()) {
            const auto found = files_.find(open.back());
            open.pop_back();
            if (found == files_.end() || !result.insert(found->second).second) {
                continue;
            }
            const auto required = required_.find(found->second);
            if (required != required_.end()) {
                open.insert(open.end(), required->second.begin(), required->second.end());
            }
        }
        return result;
    }

private:
    std::map<std::string, std::string> files_;
    std::map<std::string, std::set<std::string>> required_;
};

} // namespace

TEST_CASE("Published NodeSets load with nothing but the models that they require")
{
    const auto files = published_files();
    const Library library{files};
    WARN(library.files().size() << " models in " << files.size() << " files");
    for (const auto& [uri, file] : library.files()) {
        std::vector<NodeSetSource> sources;
        for (const std::string& name : library.with_required(uri)) {
            sources.push_back({name});
        }
        AddressSpace space;
        if (const auto strict = load_nodesets(space, sources); strict) {
            continue;
        } else {
            WARN(uri << " is refused: " << text(strict.error().front()));
        }
        for (NodeSetSource& source : sources) {
            source.is_lenient = true;
        }
        const auto loaded = load_nodesets(space, sources);
        std::string errors;
        for (const Problem& problem : loaded ? std::vector<Problem>{} : loaded.error()) {
            errors += text(problem) + '\n';
        }
        INFO(uri << ": " << file << " and " << sources.size() - 1 << " required\n" << errors);
        CHECK(errors.empty());
    }
}

TEST_CASE_METHOD(NodeSetFixture, "Published NodeSets load together and re-read equal")
{
    const auto files = published_files();
    if (files.empty()) {
        WARN("BUSBAR_NODESETS names no folder of NodeSet2 files: nothing to load");
        return;
    }
    NodeSetLimits limits;
    limits.max_errors = 10'000;
    const NodeSetSummary summary = load(files, limits);
    std::map<std::string, std::size_t> notes;
    for (const Problem& note : summary.notes) {
        const std::string file = note.where.substr(0, note.where.find(".xml:") + 4);
        ++notes[fs::path{file}.filename().string() + note.text.substr(0, 24)];
    }
    for (const auto& [what, count] : notes) {
        WARN(count << " notes: " << what);
    }
    for (const std::string& line : counted_repairs(summary)) {
        WARN("repaired " << line);
    }
    WARN(files.size() << " files, " << summary.node_count << " nodes, " << summary.skipped_count
                      << " skipped, " << summary.namespaces.size() << " namespaces");
    // All in one file.
    check_write_back(space, AddressSpace{}, summary.namespaces, summary);
    // Each namespace in a file of its own, all files given together.
    std::vector<NodeSetSource> written;
    for (const std::uint16_t index : summary.namespaces) {
        const auto text = write_nodeset(space, std::vector{index}, summary.extras);
        REQUIRE(text);
        written.push_back({std::string{space.namespace_uri(index)}, *text});
    }
    NodeSetFixture again;
    // Bodies of structures have namespace indices in them, so both number namespaces alike.
    for (std::uint16_t i = 1; i < space.namespace_count(); ++i) {
        REQUIRE(again.space.add_namespace(space.namespace_uri(i)));
    }
    const NodeSetSummary second = again.load(written);
    CHECK(second.node_count == summary.node_count);
    CHECK((second.extras.nodes == summary.extras.nodes));
    CHECK((second.extras.file_extensions == summary.extras.file_extensions));
    for (const std::uint16_t index : summary.namespaces) {
        const std::string uri{space.namespace_uri(index)};
        INFO(uri);
        CHECK(detail::space_hash(again.space, *again.space.namespace_index(uri)) ==
              detail::space_hash(space, index));
    }
}

} // namespace busbar::model::nodeset_files_test
