#include <catch2/catch.hpp>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/types/ids.hpp>

#include "image_fixture.hpp"
#include "server/image/structure_values.hpp"
#include "support/allocation_count.hpp"

namespace image_structure_test {

// Structures in a process image: how they lie in memory and on the wire.

using namespace busbar;
using namespace busbar::server;
using namespace busbar::test;

namespace {

using Structure = std::shared_ptr<const ImageStructure>;

const NodeId motor_encoding{2, "Motor.Binary"};

Structure make(NodeId encoding, const std::vector<ImageVariable>& members)
{
    return ImageStructure::create(std::move(encoding), members).value();
}

StatusCode refusal(const std::vector<ImageVariable>& members)
{
    const auto made = ImageStructure::create({}, members);
    return made ? StatusCode{} : made.error();
}

/// The same as `struct Axis { bool on; double position; }`.
Structure axis()
{
    return make({}, {{BuiltInType::Boolean}, {BuiltInType::Double}});
}

/// On, speeds[2][2], name, axes[2], mode.
Structure motor()
{
    return make(motor_encoding, {{BuiltInType::Boolean},
                                 {BuiltInType::Int16, {2, 2}},
                                 {BuiltInType::String, {}, 5},
                                 {BuiltInType::ExtensionObject, {2}, 0, axis()},
                                 {BuiltInType::Int32}});
}

enum Member : std::size_t { On, Speeds, Name, Axes, Mode };

StructureField field(const char* name, NodeId type, std::vector<std::uint32_t> dimensions = {})
{
    StructureField made;
    made.name = String{name};
    made.data_type = std::move(type);
    made.value_rank = dimensions.empty() ? -1 : static_cast<std::int32_t>(dimensions.size());
    made.array_dimensions = Array<std::uint32_t>{dimensions};
    return made;
}

binary::DataTypeEntry entry(NodeId id, NodeId encoding, std::vector<StructureField> fields)
{
    StructureDefinition definition;
    definition.base_data_type = NodeId{0, id::Structure};
    definition.default_encoding_id = encoding;
    definition.fields = Array<StructureField>{fields};
    binary::DataTypeEntry made;
    made.id = std::move(id);
    made.name = String{"T"};
    made.encoding_id = std::move(encoding);
    made.definition = std::move(definition);
    return made;
}

/// What a client knows of motor() from its DataTypeDefinition.
binary::DynamicTypes motor_types()
{
    auto entries = binary::namespace0_data_types();
    entries.push_back(
        entry(NodeId{2, 1}, {},
              {field("On", NodeId{0, id::Boolean}), field("Position", NodeId{0, id::Double})}));
    entries.push_back(
        entry(NodeId{2, 2}, motor_encoding,
              {field("On", NodeId{0, id::Boolean}), field("Speeds", NodeId{0, id::Int16}, {2, 2}),
               field("Name", NodeId{0, id::String}), field("Axes", NodeId{2, 1}, {2}),
               field("Mode", NodeId{0, id::Int32})}));
    return binary::DynamicTypes::compile(std::move(entries));
}

struct MotorFixture {
    MotorFixture()
    {
        ImageLayout layout;
        motor = layout.add({BuiltInType::ExtensionObject, {}, 0, type}).value();
        number = layout.add({BuiltInType::Int16}).value();
        motors = layout.add({BuiltInType::ExtensionObject, {3}, 0, type}).value();
        image = ProcessImage::create(std::move(layout));
        source = std::make_unique<ImageSource>(image);
        caller = std::make_unique<SourceCaller>(*source);
        image->publish(at(1));
    }
    void fill(StructureView view, std::int16_t seed)
    {
        view.value<bool>(On) = true;
        for (std::int16_t& speed : view.values<std::int16_t>(Speeds)) {
            speed = seed++;
        }
        CHECK(view.set_text(Name, "M" + std::to_string(seed)));
        view.inner(Axes, 0).value<double>(1) = 0.5;
        view.inner(Axes, 1).value<bool>(0) = true;
        view.value<std::int32_t>(Mode) = -seed;
    }
    [[nodiscard]] Variant read(std::uint32_t handle) { return caller->read({handle})[0].value; }
    /// The result of a Write that a scan takes in.
    [[nodiscard]] StatusCode write(std::uint32_t handle, Variant value, const char* range = nullptr)
    {
        const auto parsed = NumericRange::parse(range != nullptr ? range : "").value();
        const DataValue data{std::move(value)};
        server::detail::DataSources sources{&waker};
        ImageSource own{image};
        sources.add(own);
        server::detail::SourceWrite call{sources, 1};
        call.ask(0, 0, {handle, range != nullptr ? &parsed : nullptr, &data});
        CallEnd owner;
        owner.done = call.start(owner, TimePoint{}, [](auto&) {});
        image->begin_scan();
        image->publish(at(2));
        sources.handle_completions();
        REQUIRE(owner.done);
        return call.result(0);
    }

    Structure type{image_structure_test::motor()};
    std::uint32_t motor, number, motors;
    TestWaker waker;
    std::shared_ptr<ProcessImage> image;
    std::unique_ptr<ImageSource> source;
    std::unique_ptr<SourceCaller> caller;
};

ExtensionObject object(const Variant& value, std::size_t element)
{
    return (*value.array_if<ExtensionObject>())[element];
}

ExtensionObject with_body(std::vector<std::byte> bytes)
{
    return ExtensionObject::from_binary(motor_encoding, ByteString{bytes});
}

std::vector<std::byte> body_of(const ExtensionObject& object)
{
    const auto body = object.binary().span();
    return {body.begin(), body.end()};
}

} // namespace

TEST_CASE("a structure lies in the image as a C compiler lays it out")
{
    struct CAxis {
        bool on;
        double position;
    };
    struct CMotor {
        bool on;
        std::int16_t speeds[2][2];
        struct {
            std::uint32_t size;
            char bytes[8];
        } name;
        CAxis axes[2];
        std::int32_t mode;
    };
    const auto type = motor();
    CHECK(type->size() == sizeof(CMotor));
    CHECK(type->alignment() == alignof(CMotor));
    CHECK(type->members()[Speeds].offset == offsetof(CMotor, speeds));
    CHECK(type->members()[Name].offset == offsetof(CMotor, name));
    CHECK(type->members()[Axes].offset == offsetof(CMotor, axes));
    CHECK(type->members()[Axes].stride == sizeof(CAxis));
    CHECK(type->members()[Mode].offset == offsetof(CMotor, mode));
    CHECK(type->max_wire_size() == 1 + (12 + 8) + (4 + 5) + (4 + 2 * 9) + 4);
    CHECK(type->has_texts());
    CHECK_FALSE(axis()->has_texts());
}

TEST_CASE("a structure has limits")
{
    CHECK(refusal({}) == status::Bad_OutOfRange);
    CHECK(refusal(std::vector<ImageVariable>(10'001, {BuiltInType::Byte})) ==
          status::Bad_OutOfRange);
    CHECK(refusal({{BuiltInType::NodeId}}) == status::Bad_DataTypeIdUnknown);
    CHECK(refusal({{BuiltInType::ExtensionObject}}) == status::Bad_DataTypeIdUnknown);
    CHECK(refusal({{BuiltInType::Int16, {2, 0}}}) == status::Bad_OutOfRange);
    CHECK(refusal({{BuiltInType::Byte, {200U << 20U}}, {BuiltInType::Byte, {200U << 20U}}}) ==
          status::Bad_OutOfMemory);
    Structure type = axis();
    for (std::size_t level = 2; level <= ImageStructure::max_depth; ++level) {
        type = make({}, {{BuiltInType::ExtensionObject, {}, 0, type}});
    }
    CHECK(refusal({{BuiltInType::ExtensionObject, {}, 0, type}}) == status::Bad_OutOfRange);
    ImageLayout layout;
    CHECK(layout.add({BuiltInType::ExtensionObject}).error() == status::Bad_DataTypeIdUnknown);
    CHECK(layout.add({BuiltInType::ExtensionObject, {20'000'000}, 0, axis()}).error() ==
          status::Bad_OutOfMemory);
}

TEST_CASE_METHOD(MotorFixture, "a structure goes out as its DataTypeDefinition says")
{
    fill(image->memory().structure(motor), 10);
    image->publish(at(2));
    const Variant value = read(motor);
    const auto* const sent = value.get_if<ExtensionObject>();
    REQUIRE(sent != nullptr);
    const auto types = motor_types();
    const auto seen = binary::decode_dynamic(*sent, types);
    REQUIRE(seen);
    CHECK(*seen->value("On") == Variant{true});
    CHECK(*seen->value("Speeds") ==
          Variant::matrix(Array<std::int16_t>{10, 11, 12, 13}, Array<std::uint32_t>{2, 2}));
    CHECK(*seen->value("Name") == Variant{"M14"});
    CHECK(*seen->value("Mode") == Variant{-14});
    const auto& axes = seen->structures("Axes")->values;
    REQUIRE(axes.size() == 2);
    CHECK(*axes[0].value("Position") == Variant{0.5});
    CHECK(*axes[1].value("On") == Variant{true});
    CHECK(image->memory().load(motor) == value);
    CHECK(image->pin().value(motor) == value);
}

TEST_CASE_METHOD(MotorFixture, "texts in structures begin as null")
{
    const auto types = motor_types();
    const auto seen = binary::decode_dynamic(object(read(motors), 2), types);
    REQUIRE(seen);
    CHECK(*seen->value("Name") == Variant{String{}});
}

TEST_CASE_METHOD(MotorFixture, "a structure whose text is not UTF-8 is refused (Part 6, 5.2.2.4)")
{
    fill(image->memory().structure(motor), 10);
    fill(image->memory().structure(motors, 1), 3);
    CHECK(image->memory().structure(motors, 1).set_text(Name, "ab\xC3"));
    image->publish(at(2));
    const auto read = caller->read({motors, motor, motors, number});
    CHECK(read[0].status == status::Bad_EncodingError);
    CHECK(read[1].status == status::Good);
    CHECK_FALSE(read[1].value.is_null());
    CHECK(read[2].status == status::Bad_EncodingError);
    CHECK(read[3].status == status::Good);
}

TEST_CASE_METHOD(MotorFixture, "a structure is written as a whole at the scan's edge")
{
    fill(image->memory().structure(motors, 1), 3);
    image->publish(at(2));
    const ExtensionObject written = object(read(motors), 1);
    CHECK(write(motor, written) == status::Good);
    CHECK(read(motor) == Variant{written});
    CHECK(image->memory().structure(motor).text(Name) == "M7");
    CHECK(image->memory().structure(motor).inner(Axes, 0).value<double>(1) == 0.5);

    const Variant all{Array<ExtensionObject>{written, object(read(motors), 0), written}};
    CHECK(write(motors, all) == status::Good);
    CHECK(read(motors) == all);
    CHECK(image->memory().store(motor, object(all, 1)) == status::Good);
    CHECK(image->memory().load(motor) == Variant{object(all, 1)});
}

TEST_CASE_METHOD(MotorFixture, "elements of an array of structures are written by range")
{
    fill(image->memory().structure(motor), 3);
    image->publish(at(2));
    const ExtensionObject one = *read(motor).get_if<ExtensionObject>();
    const ExtensionObject zero = object(read(motors), 0);
    CHECK(write(motors, Array<ExtensionObject>{one, one}, "1:2") == status::Good);
    CHECK(read(motors) == Variant{Array<ExtensionObject>{zero, one, one}});
    CHECK(write(motors, Array<ExtensionObject>{one}, "3") == status::Bad_IndexRangeNoData);
    CHECK(write(motors, Array<ExtensionObject>{one}, "0:1") == status::Bad_IndexRangeDataMismatch);
    CHECK(write(motors, Array<std::int16_t>{1}, "0") == status::Bad_TypeMismatch);
    CHECK(write(motors, Array<ExtensionObject>{zero, ExtensionObject{}}, "1:2") ==
          status::Bad_TypeMismatch);
    CHECK(read(motors) == Variant{Array<ExtensionObject>{zero, one, one}});
}

TEST_CASE_METHOD(MotorFixture, "a structure that does not fit its variable is refused")
{
    fill(image->memory().structure(motor), 3);
    image->publish(at(2));
    const Variant before = read(motor);
    const auto good = body_of(*before.get_if<ExtensionObject>());
    const auto changed = [&](std::size_t at_byte, int value) {
        auto bytes = good;
        bytes[at_byte] = static_cast<std::byte>(value);
        return with_body(std::move(bytes));
    };
    constexpr std::size_t rank = 1;
    constexpr std::size_t first_dimension = 5;
    constexpr std::size_t name_size = 21;
    CHECK(write(motor, changed(rank, 1)) == status::Bad_TypeMismatch);
    CHECK(write(motor, changed(first_dimension, 3)) == status::Bad_TypeMismatch);
    CHECK(write(motor, changed(name_size, 6)) == status::Bad_OutOfRange);
    CHECK(write(motor, changed(name_size + 3, 0x7F)) == status::Bad_DecodingError);
    CHECK(write(motor, std::int16_t{1}) == status::Bad_TypeMismatch);
    CHECK(write(motor, ExtensionObject{}) == status::Bad_TypeMismatch);
    CHECK(write(motor, ExtensionObject::from_binary(NodeId{2, 9}, ByteString{good})) ==
          status::Bad_TypeMismatch);
    CHECK(write(motor, ExtensionObject::from_id(motor_encoding)) == status::Bad_TypeMismatch);
    CHECK(write(motor, Array<ExtensionObject>{with_body(good)}) == status::Bad_TypeMismatch);
    for (std::size_t size = 0; size < good.size(); ++size) {
        CHECK(write(motor, with_body({good.begin(), good.begin() + static_cast<long>(size)})) ==
              status::Bad_DecodingError);
    }
    auto longer = good;
    longer.push_back(std::byte{0});
    CHECK(write(motor, with_body(longer)) == status::Bad_DecodingError);
    CHECK(image->memory().store(motor, with_body(longer)) == status::Bad_DecodingError);
    CHECK(read(motor) == before);
    auto truth = good; // any byte but 0 is true (Part 6, 5.2.2.1)
    truth[0] = std::byte{0x80};
    CHECK(write(motor, with_body(truth)) == status::Good);
    CHECK(read(motor) == before);
}

TEST_CASE_METHOD(MotorFixture, "an item that is refused leaves nothing behind")
{
    fill(image->memory().structure(motors, 0), 3);
    image->publish(at(2));
    const ExtensionObject good = object(read(motors), 0);
    const DataValue bad{Variant{Array<ExtensionObject>{good, good, ExtensionObject{}}}};
    const DataValue fine{Variant{good}};
    server::detail::DataSources sources{&waker};
    ImageSource own{image};
    sources.add(own);
    server::detail::SourceWrite call{sources, 2};
    call.ask(0, 0, {motors, nullptr, &bad});
    call.ask(1, 0, {motor, nullptr, &fine});
    CallEnd owner;
    CHECK_FALSE(call.start(owner, TimePoint{}, [](auto&) {}));
    image->begin_scan();
    image->publish(at(3));
    sources.handle_completions();
    CHECK(call.result(0) == status::Bad_TypeMismatch);
    CHECK(call.result(1) == status::Good);
    CHECK(read(motor) == Variant{good});
    CHECK(object(read(motors), 1) != good);
}

TEST_CASE_METHOD(MotorFixture, "what a pin has made of structures stays until it is recycled")
{
    fill(image->memory().structure(motor), 1);
    image->publish(at(2));
    const ImagePin pin = image->pin();
    ReadSlot slot;
    ReadSlot again;
    REQUIRE(pin.read(motor, slot));
    REQUIRE(pin.read(motors, again));
    REQUIRE(pin.read(motor, again));
    CHECK(again.shared == slot.shared); // however often a Read names it
    const Variant before{*slot.shared};
    image->memory().structure(motor).value<std::int32_t>(Mode) = 77;
    image->publish(at(3));
    CHECK(*slot.shared == before);
    pin.recycle();
    REQUIRE(pin.read(motor, slot));
    CHECK(*slot.shared == before);
    CHECK(image->pin().value(motor) != before);
}

TEST_CASE_METHOD(MotorFixture, "a pin that is recycled keeps the memory for few structures")
{
    const ImagePin pin = image->pin();
    ReadSlot slot;
    REQUIRE(pin.read(motor, slot));
    pin.recycle();
    const std::size_t before = allocated_bytes();
    for (int i = 0; i < 10; ++i) {
        static_cast<void>(pin.read(motor, slot));
        pin.recycle();
    }
    CHECK(allocated_bytes() - before < server::detail::StructureValues::usual_block);
}

} // namespace image_structure_test
