#include <string>

#include "files_fixture.hpp"

namespace file_faults_test {

// Part 20, 4.2 and 4.3: Methods of files and directories that are called wrongly, beyond their
// limits or while a medium fails.

using namespace busbar;
using namespace busbar::test;

namespace {

struct FileFaults : FilesFixture {
    FileFaults() { REQUIRE(file_storage.make_folder("", FileAccess::Owner)); }

    void store(const std::string& path, std::string_view text)
    {
        REQUIRE(file_storage.replace(path, std::as_bytes(std::span{text}), FileAccess::Owner));
    }
    [[nodiscard]] std::string stored(const std::string& path)
    {
        const auto bytes = read_file(file_storage, path, 1'000);
        return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                     : std::string{};
    }
    void refresh()
    {
        administration->refresh_files();
        complete();
    }
};

} // namespace

TEST_CASE_METHOD(FileFaults, "file faults: a handle that nobody has is refused by every Method")
{
    store("a", "one");
    store("b", "two");
    refresh();
    auto client = log_in_as("eng");
    const Variant other = open(client, "b", writing);
    const Variant closed = open(client, "a", reading);
    REQUIRE(why(client, "a", "Close", {closed}) == "Good");
    for (const Variant& handle : {Variant{std::uint32_t{0}}, closed, other}) {
        CHECK(why(client, "a", "Read", {handle, Variant{std::int32_t{1}}}) ==
              "Bad_InvalidArgument");
        CHECK(why(client, "a", "Write", {handle, Variant{ByteString{}}}) == "Bad_InvalidArgument");
        CHECK(why(client, "a", "GetPosition", {handle}) == "Bad_InvalidArgument");
        CHECK(why(client, "a", "SetPosition", {handle, Variant{std::uint64_t{0}}}) ==
              "Bad_InvalidArgument");
        CHECK(why(client, "a", "Close", {handle}) == "Bad_InvalidArgument");
    }
    CHECK(why(client, "b", "Close", {other}) == "Good");
}

TEST_CASE_METHOD(FileFaults, "file faults: what is open with no more room is not made")
{
    auto client = log_in_as("eng");
    for (int i = 0; i < 8; ++i) {
        REQUIRE(
            on(client, "", "CreateFile", {Variant{String{"f" + std::to_string(i)}}, Variant{true}})
                .status_code == status::Good);
    }
    CHECK(why(client, "", "CreateFile", {Variant{String{"late"}}, Variant{true}}) ==
          "Bad_TooManyOperations");
    CHECK_FALSE(is_stored("late"));
    CHECK(names(client).size() == 8);
    CHECK(make(client, "", "late") == "Good"); // without a handle
}

TEST_CASE_METHOD(FileFaults, "file faults: a folder that cannot be made is not shown")
{
    auto client = log_in_as("eng");
    storage.set_protected(true);
    CHECK(make_folder(client, "", "press") == "Bad_ResourceUnavailable");
    storage.set_protected(false);
    CHECK(names(client).empty());
    storage.set_away(true);
    CHECK(make_folder(client, "", "press") == "Bad_ResourceUnavailable");
    CHECK(make(client, "", "press") == "Bad_ResourceUnavailable");
    storage.set_away(false);
    CHECK(make_folder(client, "", "press") == "Good");
}

TEST_CASE_METHOD(FileFaults, "file faults: targets and sources that are none are not found")
{
    store("a", "one");
    store("b", "two");
    refresh();
    auto client = log_in_as("eng");
    const auto move_to = [&](const Variant& what, const Variant& target) {
        return why(client, "", "MoveOrCopy", {what, target, Variant{false}, Variant{String{"c"}}});
    };
    const Variant source{node("a")};
    const Variant root{node("")};
    for (const Variant& wrong :
         {Variant{NodeId{}}, Variant{NodeId{0, id::ObjectsFolder}}, Variant{NodeId{1, 7U}},
          Variant{NodeId{1, "Files/recipe"}}, Variant{NodeId{1, "Files/recipes2"}},
          Variant{NodeId{1, "Files/recipes "}}, Variant{NodeId{1, "Files/recipes/none"}},
          Variant{NodeId{2, "Files/recipes"}}}) {
        CHECK(move_to(source, wrong) == "Bad_NotFound");
        CHECK(move_to(wrong, root) == "Bad_NotFound");
        CHECK(why(client, "", "Delete", {wrong}) == "Bad_NotFound");
    }
    CHECK(move_to(source, Variant{node("b")}) == "Bad_NotFound"); // no folder
    CHECK(move_to(source, root) == "Good");
    CHECK(names(client) == Names{"b", "c"});
}

TEST_CASE_METHOD(FileFaults, "file faults: one Call that removes a file and goes on with it")
{
    store("a", "one");
    refresh();
    auto client = log_in_as("eng");
    CallRequest request;
    request.methods_to_call.resize(3);
    request.methods_to_call[0].object_id = node("");
    request.methods_to_call[0].method_id = folder_method("Delete");
    request.methods_to_call[0].input_arguments = {Variant{node("a")}};
    request.methods_to_call[1].object_id = node("a");
    request.methods_to_call[1].method_id = file_method("Open");
    request.methods_to_call[1].input_arguments = {Variant{reading}};
    request.methods_to_call[2] = request.methods_to_call[0];
    const auto sent = client.send(request);
    complete();
    const auto response = client.take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Good");
    CHECK(response->results[1].status_code.is_bad());
    CHECK(name(response->results[2].status_code) == "Bad_NotFound");
}

TEST_CASE_METHOD(FileFaults, "file faults: a file that is too large is not copied or loaded")
{
    const std::vector<std::byte> much((16U << 20U) + 1);
    REQUIRE(file_storage.replace("large", much, FileAccess::Owner));
    refresh();
    auto client = log_in_as("eng");
    CHECK(value(client, "large", "Size").value == Variant{std::uint64_t{much.size()}});
    CHECK(move(client, "", "large", "", "copy", true) == "Bad_EncodingLimitsExceeded");
    CHECK_FALSE(is_stored("copy"));
    CHECK(why(client, "large", "Open", {Variant{std::uint8_t{2}}}) == "Bad_EncodingLimitsExceeded");
    CHECK(move(client, "", "large", "", "moved") == "Good");
    CHECK(is_stored("moved"));
}

TEST_CASE_METHOD(FileFaults, "file faults: a folder that has no room to be copied is left alone")
{
    auto client = log_in_as("eng");
    REQUIRE(make_folder(client, "", "from") == "Good");
    for (const char* each : {"a", "b", "c", "d", "e", "f"}) {
        REQUIRE(make(client, "from", each) == "Good");
    }
    CHECK(move(client, "", "from", "", "to", true) == "Bad_ResourceUnavailable"); // 14 of 12
    CHECK_FALSE(is_stored("to"));
    CHECK(move(client, "", "from", "", "to") == "Good");
    CHECK(names(client, "to").size() == 6);
}

TEST_CASE_METHOD(FileFaults, "file faults: a copy that the medium has no room for is told")
{
    auto client = log_in_as("eng");
    REQUIRE(make_folder(client, "", "from") == "Good");
    REQUIRE(make(client, "from", "a") == "Good");
    write(client, "from/a", std::string(500, 'x'));
    std::uint64_t used = 0;
    for (const std::string& each : storage.names()) {
        used += storage.entry(each)->size;
    }
    storage.set_capacity(used + 499);
    CHECK(move(client, "from", "from/a", "from", "b", true) == "Bad_ResourceUnavailable");
    CHECK(names(client, "from") == Names{"a"});
    CHECK(move(client, "", "from", "", "to", true) == "Bad_ResourceUnavailable");
    CHECK(text(client, "from/a") == std::string(500, 'x'));
    storage.set_capacity(used + 500);
    CHECK(move(client, "from", "from/a", "from", "b", true) == "Good");
}

TEST_CASE_METHOD(FileFaults, "file faults: a folder on its way loses nothing when a step fails")
{
    auto client = log_in_as("eng");
    bool is_done = false;
    std::size_t failed = 0;
    for (std::size_t step = 0; !is_done; ++step) {
        REQUIRE(step < 100);
        REQUIRE(file_storage.make_folder("from", FileAccess::Owner));
        store("from/a", "one");
        store("from/b", "two");
        refresh();
        storage.fail_once_after(step, StorageError::Failed);
        const auto done = move(client, "", "from", "", "to");
        storage.fail_once_after(SIZE_MAX / 2, StorageError::Failed); // no more
        is_done = done == "Good";
        CHECK((is_done || done == "Bad_ResourceUnavailable"));
        failed += is_done ? 0 : 1;
        INFO(step);
        for (const auto& [path, bytes] : {std::pair{"a", "one"}, std::pair{"b", "two"}}) {
            const std::string here = stored("from/" + std::string{path});
            const std::string there = stored("to/" + std::string{path});
            CHECK((here == bytes || there == bytes));
            CHECK((is_done ? here.empty() : here.empty() || there.empty()));
        }
        CHECK(names(client, "from").size() + names(client, "to").size() == 2);
        if (is_stored("to")) {
            CHECK(why(client, "", "Delete", {Variant{node("to")}}) == "Good");
        }
    }
    CHECK(failed >= 4);
}

TEST_CASE_METHOD(FileFaults, "file faults: a folder that cannot be removed is shown as it is")
{
    auto client = log_in_as("eng");
    REQUIRE(make_folder(client, "", "press") == "Good");
    REQUIRE(make(client, "press", "a") == "Good");
    REQUIRE(make(client, "press", "b") == "Good");
    storage.fail_once_after(1, StorageError::Failed);
    CHECK(why(client, "", "Delete", {Variant{node("press")}}) == "Bad_ResourceUnavailable");
    CHECK(names(client, "press") == Names{"b"});
    CHECK(is_stored("press/b"));
    CHECK(why(client, "", "Delete", {Variant{node("press")}}) == "Good");
    CHECK_FALSE(is_stored("press"));
}

TEST_CASE_METHOD(FileFaults, "file faults: what others change the kind of, or hide, is followed")
{
    store("a", "one");
    store(".hidden", "x");
    REQUIRE(file_storage.make_folder("press", FileAccess::Owner));
    store("press/b", "two");
    refresh();
    auto client = log_in_as("op");
    CHECK(names(client) == Names{"a", "press"});
    REQUIRE(file_storage.remove("a"));
    REQUIRE(file_storage.make_folder("a", FileAccess::Owner));
    REQUIRE(file_storage.remove("press/b"));
    REQUIRE(file_storage.remove("press"));
    store("press", "three");
    refresh();
    CHECK(text(client, "press") == "three");
    CHECK(value(client, "a", "Size").status == status::Bad_NodeIdUnknown);
    CHECK(value(client, "press/b", "Size").status == status::Bad_NodeIdUnknown);
    CHECK(names(client, "a").empty());
}

} // namespace file_faults_test
