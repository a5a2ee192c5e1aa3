#include <catch2/catch.hpp>

#include <limits>

#include <busbar/types/data_types.hpp>

#include "session_use.hpp"
#include "support/slow_server.hpp"

namespace write_attribute_test {

// Write of attributes other than Value (Part 4, 5.11.4), where a WriteMask allows it.

using namespace busbar;
using namespace busbar::test;

namespace {

using Mask = AttributeWriteMask;

constexpr std::uint32_t every_bit = (1U << 26U) - 1;

template <typename... T>
constexpr std::uint32_t bits_of(T... each)
{
    return (static_cast<std::uint32_t>(each) | ...);
}

server::ServerConfig german_config()
{
    server::ServerConfig config = ServerFixture::insecure_config();
    config.locale_ids = {"en", "de"};
    return config;
}

/// Says what is left of a UserWriteMask.
struct MaskControl final : server::AccessControl {
    [[nodiscard]] bool may_browse(const server::UserIdentity&, const NodeId&) const override
    {
        return true;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity&, const NodeId&,
                                                 std::uint8_t access_level) const override
    {
        return access_level;
    }
    [[nodiscard]] std::uint32_t user_write_mask(const server::UserIdentity&, const NodeId&,
                                                std::uint32_t write_mask) const override
    {
        CHECK((write_mask & bits_of(Mask::BrowseName)) == 0); // of what there is
        return write_mask & left;
    }

    std::uint32_t left{every_bit};
};

struct Deciding {
    MaskControl control;
    CountingWaker waker_of_nobody;
};

/// A Variable "Level" and the object "Press", and clients with and without rights.
struct MaskFixture : Deciding, ServerFixture {
    MaskFixture() : ServerFixture{waker_of_nobody, german_config(), &control}
    {
        users.everybody.access_level_mask = 0xFF;
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Int32};
        variable.value = 7;
        level = space().add_variable(named("Level"), variable).value();
        press = space().add_object(named("Press")).value();
        REQUIRE(open.activate(TestClient::anonymous()) == status::Good); // who may write now
    }
    [[nodiscard]] model::AddressSpace& space() { return server.address_space(); }
    [[nodiscard]] model::NewNode named(const char* name)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = space().find(id::ObjectsFolder);
        return node;
    }
    void allow(model::NodeIndex node, std::uint32_t mask)
    {
        model::NodeAccess access;
        access.write_mask = mask;
        space().set_node_access(node, access);
    }
    static StatusCode write(TestClient& client, const NodeId& node, AttributeId attribute,
                            DataValue value, const char* range = "")
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = node;
        request.nodes_to_write[0].attribute_id = static_cast<std::uint32_t>(attribute);
        request.nodes_to_write[0].index_range = range;
        request.nodes_to_write[0].value = std::move(value);
        const auto response = client.call<WriteResponse>(request);
        return response ? response->results[0] : response.error();
    }
    StatusCode write(AttributeId attribute, Variant value)
    {
        return write(admin, NodeId{1, "Level"}, attribute, DataValue{std::move(value)});
    }
    [[nodiscard]] static DataValue read(TestClient& client, const NodeId& node,
                                        AttributeId attribute)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = node;
        request.nodes_to_read[0].attribute_id = static_cast<std::uint32_t>(attribute);
        auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] Variant read(AttributeId attribute)
    {
        return read(admin, NodeId{1, "Level"}, attribute).value;
    }
    [[nodiscard]] Variant mask_of(TestClient& client)
    {
        return read(client, NodeId{1, "Level"}, AttributeId::UserWriteMask).value;
    }

    model::NodeIndex level{};
    model::NodeIndex press{};
    TestClient open{log_in()};
    TestClient admin{log_in_as("admin")};
};

Variant permissions(std::initializer_list<RolePermissionType> all)
{
    Array<ExtensionObject> objects;
    objects.clear();
    for (const RolePermissionType& each : all) {
        objects.push_back(ExtensionObject::from(each));
    }
    return Variant{std::move(objects)};
}

} // namespace

TEST_CASE_METHOD(MaskFixture, "a WriteMask says what can be written and nothing else")
{
    CHECK(read(AttributeId::WriteMask) == Variant{0U}); // unless somebody allows it
    allow(level, every_bit);
    allow(press, every_bit);
    allow(space().find(id::Server), every_bit);
    const std::uint32_t all = bits_of(Mask::DisplayName, Mask::Description, Mask::RolePermissions,
                                      Mask::AccessRestrictions);
    CHECK(read(AttributeId::WriteMask) == Variant{all | bits_of(Mask::MinimumSamplingInterval)});
    CHECK(mask_of(admin) == read(AttributeId::WriteMask));
    CHECK(read(admin, NodeId{1, "Press"}, AttributeId::WriteMask).value == Variant{all});
    CHECK(read(admin, NodeId{0, id::Server}, AttributeId::WriteMask).value == Variant{0U});

    CHECK(write(AttributeId::BrowseName, Variant{QualifiedName{1, "L"}}) ==
          status::Bad_WriteNotSupported);
    CHECK(write(AttributeId::Historizing, Variant{true}) == status::Bad_WriteNotSupported);
    CHECK(write(AttributeId::WriteMask, Variant{0U}) == status::Bad_WriteNotSupported);
    CHECK(write(AttributeId::Executable, Variant{true}) == status::Bad_AttributeIdInvalid);
    CHECK(write(static_cast<AttributeId>(99), Variant{1}) == status::Bad_AttributeIdInvalid);
    CHECK(write(admin, NodeId{0, id::Server}, AttributeId::DisplayName,
                DataValue{Variant{LocalizedText{"S"}}}) == status::Bad_WriteNotSupported);
    allow(level, bits_of(Mask::Description));
    CHECK(write(AttributeId::DisplayName, Variant{LocalizedText{"L"}}) == status::Bad_NotWritable);
}

TEST_CASE_METHOD(MaskFixture, "texts of a node are written in the locales of the server")
{
    allow(level, bits_of(Mask::DisplayName, Mask::Description));
    const auto text = [&](AttributeId attribute) { return read(attribute); };
    CHECK(read(admin, NodeId{1, "Level"}, AttributeId::Description).status ==
          status::Bad_AttributeIdInvalid); // it has none yet
    CHECK(write(AttributeId::Description, Variant{LocalizedText{"en", "How full it is"}}) ==
          status::Good);
    CHECK(write(AttributeId::Description, Variant{LocalizedText{"de", "Wie voll"}}) ==
          status::Good);
    CHECK(text(AttributeId::Description) == Variant{LocalizedText{"en", "How full it is"}});
    CHECK(space().texts(level, AttributeId::Description).size() == 2);
    CHECK(write(AttributeId::DisplayName, Variant{LocalizedText{"", "Level 1"}}) == status::Good);
    CHECK(text(AttributeId::DisplayName) == Variant{LocalizedText{"Level 1"}});
    CHECK(write(AttributeId::DisplayName, Variant{LocalizedText{}}) == status::Good);
    CHECK(text(AttributeId::DisplayName).get_if<LocalizedText>()->text.view() == "Level");

    CHECK(write(AttributeId::DisplayName, Variant{LocalizedText{"fr", "Niveau"}}) ==
          status::Bad_LocaleNotSupported);
    CHECK(write(AttributeId::DisplayName, Variant{"Level"}) == status::Bad_TypeMismatch);
    CHECK(write(AttributeId::DisplayName, Variant{Array<LocalizedText>{LocalizedText{"a"}}}) ==
          status::Bad_TypeMismatch);
    CHECK(write(AttributeId::DisplayName, Variant{}) == status::Bad_TypeMismatch);
    // Not in parts, not with a status, not with a time.
    const NodeId node{1, "Level"};
    const DataValue good{Variant{LocalizedText{"L"}}};
    CHECK(write(admin, node, AttributeId::DisplayName, good, "0") == status::Bad_WriteNotSupported);
    CHECK(write(admin, node, AttributeId::DisplayName, good, "x") == status::Bad_IndexRangeInvalid);
    DataValue odd = good;
    odd.status = status::Uncertain_LastUsableValue;
    CHECK(write(admin, node, AttributeId::DisplayName, odd) == status::Bad_WriteNotSupported);
    odd = good;
    odd.source_timestamp = today;
    CHECK(write(admin, node, AttributeId::DisplayName, odd) == status::Bad_WriteNotSupported);
    CHECK(text(AttributeId::DisplayName).get_if<LocalizedText>()->text.view() == "Level");
}

TEST_CASE_METHOD(MaskFixture, "a MinimumSamplingInterval is a time or is not known")
{
    allow(level, bits_of(Mask::MinimumSamplingInterval));
    for (const double interval : {250.0, 0.0, -1.0}) {
        CHECK(write(AttributeId::MinimumSamplingInterval, Variant{interval}) == status::Good);
        CHECK(read(AttributeId::MinimumSamplingInterval) == Variant{interval});
    }
    for (const double interval : {-2.0, std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::quiet_NaN()}) {
        CHECK(write(AttributeId::MinimumSamplingInterval, Variant{interval}) ==
              status::Bad_OutOfRange);
    }
    CHECK(write(AttributeId::MinimumSamplingInterval, Variant{1}) == status::Bad_TypeMismatch);
    CHECK(read(AttributeId::MinimumSamplingInterval) == Variant{-1.0});
}

TEST_CASE_METHOD(MaskFixture, "rights of a node are changed by whoever has the right to")
{
    const std::uint32_t rights = bits_of(Mask::RolePermissions, Mask::AccessRestrictions);
    allow(level, rights | bits_of(Mask::Description));
    // Where nobody is named, texts are for those who may write, and rights for administrators.
    CHECK(mask_of(open) == Variant{bits_of(Mask::Description)});
    const NodeId node{1, "Level"};
    const Variant everything = permissions(
        {{NodeId{0, id::WellKnownRole_Anonymous}, PermissionType::Browse},
         {NodeId{0, id::WellKnownRole_SecurityAdmin}, PermissionType{(1U << 17U) - 1}}});
    CHECK(write(open, node, AttributeId::RolePermissions, DataValue{everything}) ==
          status::Bad_UserAccessDenied);
    CHECK(write(open, node, AttributeId::AccessRestrictions,
                DataValue{Variant{std::uint16_t{0}}}) == status::Bad_UserAccessDenied);
    CHECK(write(AttributeId::RolePermissions, everything) == status::Good);
    REQUIRE(space().role_permissions(level) != nullptr);
    CHECK(space().role_permissions(level)->size() == 2);
    CHECK(read(open, node, AttributeId::Value).status == status::Bad_UserAccessDenied);
    CHECK(mask_of(open) == Variant{0U});
    CHECK(mask_of(admin) == Variant{rights | bits_of(Mask::Description)});
    CHECK(read(AttributeId::WriteMask) == mask_of(admin)); // it is still there

    CHECK(write(AttributeId::AccessRestrictions, Variant{std::uint16_t{2}}) == status::Good);
    CHECK(read(AttributeId::AccessRestrictions) == Variant{std::uint16_t{2}});
    CHECK(write(open, node, AttributeId::Description, DataValue{Variant{LocalizedText{"a"}}}) ==
          status::Bad_SecurityModeInsufficient);
    CHECK(write(AttributeId::AccessRestrictions, Variant{std::uint16_t{16}}) ==
          status::Bad_OutOfRange);
    CHECK(write(AttributeId::AccessRestrictions, Variant{2}) == status::Bad_TypeMismatch);
}

TEST_CASE_METHOD(MaskFixture, "RolePermissions that are none change nothing")
{
    allow(level, bits_of(Mask::RolePermissions));
    const RolePermissionType good{NodeId{0, id::WellKnownRole_SecurityAdmin},
                                  PermissionType{(1U << 17U) - 1}};
    REQUIRE(write(AttributeId::RolePermissions, permissions({good})) == status::Good);
    CHECK(write(AttributeId::RolePermissions, Variant{7}) == status::Bad_TypeMismatch);
    CHECK(write(AttributeId::RolePermissions, Variant{ExtensionObject::from(good)}) ==
          status::Bad_TypeMismatch);
    CHECK(write(AttributeId::RolePermissions,
                Variant{Array<ExtensionObject>{ExtensionObject::from(good),
                                               ExtensionObject::from(Argument{})}}) ==
          status::Bad_TypeMismatch);
    CHECK(write(AttributeId::RolePermissions,
                permissions(
                    {good, {NodeId{0, id::WellKnownRole_Operator}, PermissionType{1U << 17U}}})) ==
          status::Bad_OutOfRange);
    const Variant too_many{Array<ExtensionObject>(std::vector<ExtensionObject>(101))};
    CHECK(write(AttributeId::RolePermissions, too_many) == status::Bad_OutOfRange);
    CHECK(*space().role_permissions(level) == Array<RolePermissionType>{good});
}

TEST_CASE_METHOD(MaskFixture, "WriteAttribute and WriteRolePermissions are two rights")
{
    const NodeId node{1, "Level"};
    model::NodeAccess access;
    access.write_mask = bits_of(Mask::Description, Mask::RolePermissions, Mask::AccessRestrictions);
    const auto mask_with = [&](PermissionType permission) {
        access.role_permissions = {{NodeId{0, id::WellKnownRole_Anonymous},
                                    PermissionType{bits_of(permission, PermissionType::Browse)}}};
        space().set_node_access(level, access);
        return mask_of(open);
    };
    CHECK(mask_with(PermissionType::WriteAttribute) == Variant{bits_of(Mask::Description)});
    CHECK(mask_with(PermissionType::WriteRolePermissions) ==
          Variant{bits_of(Mask::RolePermissions)});
    CHECK(mask_with(PermissionType{
              bits_of(PermissionType::WriteAttribute, PermissionType::WriteRolePermissions)}) ==
          Variant{access.write_mask});
    CHECK(mask_with(PermissionType::Write) == Variant{0U});
    mask_with(PermissionType::WriteAttribute);
    CHECK(write(open, node, AttributeId::Description, DataValue{Variant{LocalizedText{"a"}}}) ==
          status::Good);
    control.left = bits_of(Mask::DisplayName);
    CHECK(mask_of(open) == Variant{0U});
    CHECK(write(open, node, AttributeId::Description, DataValue{Variant{LocalizedText{"b"}}}) ==
          status::Bad_UserAccessDenied);
}

} // namespace write_attribute_test
