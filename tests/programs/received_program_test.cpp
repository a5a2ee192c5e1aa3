#include "product/store/received_program.hpp"

#include <catch2/catch.hpp>

#include <memory>
#include <optional>
#include <string>

#include <busbar/storage/folder_storage.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "product/store/source_files.hpp"
#include "support/temporary_folder.hpp"

namespace received_program_test {

// The document of a program that was sent to a controller.

using namespace busbar;
using namespace busbar::product;

namespace {

const ReceivedProgram press{.name = "press.st",
                            .user = "pat\nof the press",
                            .time = DateTime::from_unix_seconds(1'000'000),
                            .text = "VAR_GLOBAL\n  Speed : INT;\nEND_VAR\n"};

} // namespace

TEST_CASE("received program: a document has all of it, in lines")
{
    const auto read = read_received(document_of(press), "here");
    REQUIRE(read);
    CHECK(read->name == "press.st");
    CHECK(read->user == "pat of the press");
    CHECK(read->time.ticks == press.time.ticks);
    CHECK(read->text == press.text);
    CHECK(read_received(document_of({.name = "empty.xml"}), "here")->text.empty());
}

TEST_CASE("received program: any damage is found")
{
    const std::string document = document_of(press);
    for (std::size_t i = 0; i < document.size(); ++i) {
        std::string damaged = document;
        damaged[i] = static_cast<char>(damaged[i] ^ 1);
        CHECK_FALSE(read_received(damaged, "here"));
        CHECK_FALSE(read_received(document.substr(0, i), "here"));
    }
    const auto refused = read_received(document + "more", "here");
    CHECK(text(refused.error()) == "here: the program that was received is damaged");
}

TEST_CASE("received program: a name is none of a path")
{
    CHECK(is_program_name("press 4.st"));
    for (const char* name : {"", "../press.st", "a/b", "a\\b", " press.st", "press\n.st"}) {
        INFO(name);
        CHECK_FALSE(is_program_name(name));
        CHECK_FALSE(read_received(document_of({.name = name}), "here"));
    }
    CHECK(is_program_name(std::string(255, 'a')));
    CHECK_FALSE(is_program_name(std::string(256, 'a')));
}

TEST_CASE("received program: a power cut leaves the one before or the next one")
{
    const std::string first = document_of(press);
    const std::string second = document_of({.name = "other.st", .text = "other"});
    const auto check_cuts = [&](const std::optional<std::string>& next) {
        bool was_cut = true;
        for (std::size_t cuts = 0; was_cut; ++cuts) {
            REQUIRE(cuts < 100);
            storage::MemoryStorage files;
            REQUIRE(keep_received(files, first));
            const std::size_t begin = files.steps();
            files.cut_power_after(cuts);
            const bool is_kept = keep_received(files, next).has_value();
            was_cut = files.steps() - begin >= cuts;
            files.restore_power();
            const auto bytes = read_file(files, ReceivedProgram::file_name, 10'000);
            const std::string now =
                bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                      : std::string{};
            CHECK((now == first || now == next.value_or("")));
            CHECK((!is_kept || now == next.value_or("")));
        }
    };
    check_cuts(second);
    check_cuts(std::nullopt);
    storage::MemoryStorage files;
    CHECK(keep_received(files, std::nullopt)); // there is none already
}

TEST_CASE("received program: it is read with the other files, and not beside those kept")
{
    test::TemporaryFolder folder;
    const std::string place = (folder.path / "program.received").string();
    SourceFiles none;
    CHECK_FALSE(none.received()->has_value());
    none.receive_at(place);
    CHECK_FALSE(none.received()->has_value());
    storage::FolderStorage storage{folder.path.string()};
    REQUIRE(keep_received(storage, document_of(press)));
    SourceFiles files;
    files.receive_at(place);
    CHECK(**files.received().value() == document_of(press));
    CHECK(files.texts().contains(place));
    SourceFiles kept{SourceFiles::Texts{{"press.toml", std::make_shared<std::string>("")}}};
    kept.receive_at(place);
    CHECK_FALSE(kept.received()->has_value());
    SourceFiles with{files.texts()};
    with.receive_at(place);
    REQUIRE(keep_received(storage, std::nullopt));
    CHECK(**with.received().value() == document_of(press));
}

} // namespace received_program_test
