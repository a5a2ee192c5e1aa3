#include <cstdlib>
#include <filesystem>
#include <map>

#include "nodeset_fixture.hpp"

// NodeSet2 files that are not part of the repository: those of the folders in the environment
// variable BUSBAR_NODESETS, separated by colons.

namespace busbar::model {

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
                files.push_back({entry.path().string()});
            }
        }
    }
    return files;
}

} // namespace

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
    for (const NodeSetError& note : summary.notes) {
        ++notes[fs::path{note.file}.filename().string() + note.message.substr(0, 24)];
    }
    for (const auto& [what, count] : notes) {
        WARN(count << " notes: " << what);
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

} // namespace busbar::model
