// Runs models with ONNX Runtime through its C interface. The library is loaded on demand, so neither the build nor a
// machine without it needs it.
#include "engine.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace detect {
namespace {

/// Places in the table of functions. Those of version 1 never change (onnxruntime_c_api.h, OrtApi).
enum Function : std::size_t {
    get_error_message = 2,
    create_env = 3,
    create_session = 7,
    run_session = 9,
    create_session_options = 10,
    set_intra_op_threads = 24,
    set_inter_op_threads = 25,
    get_input_count = 30,
    get_output_count = 31,
    get_input_name = 36,
    get_output_name = 37,
    create_tensor_with_data = 49,
    get_tensor_data = 51,
    get_element_type = 60,
    get_dimensions_count = 61,
    get_dimensions = 62,
    get_type_and_shape = 65,
    create_cpu_memory_info = 69,
    free_allocated = 76,
    get_default_allocator = 78,
    release_env = 92,
    release_status = 93,
    release_memory_info = 94,
    release_session = 95,
    release_value = 96,
    release_type_and_shape = 99,
    release_session_options = 100
};

enum ElementType : int { type_float = 1, type_int32 = 6, type_int64 = 7 };
/// Of RT-DETR and D-FINE: the size of the image, by which they multiply their boxes; here that of the input.
constexpr const char* size_input = "orig_target_sizes";
constexpr int log_fatal = 4, device_allocator = 0, default_memory = 0;

/// The functions of the library.
class Api {
public:
    explicit Api(const std::string& library)
    {
        void* const loaded = load(library);  // never unloaded: it has threads of its own
        const auto base = loaded ? reinterpret_cast<const Base* (*)()>(::dlsym(loaded, "OrtGetApiBase")) : nullptr;
        table_ = base ? base()->get_api(1) : nullptr;
        if (!table_)
            throw EngineError("cannot be run by ONNX Runtime: no usable "
                              + (library.empty() ? "libonnxruntime.so.1" : library));
    }

    /// @throws EngineError  with the error of the library
    template <class... Arguments>
    void call(Function function, Arguments... arguments) const
    {
        using Signature = void* (*)(Arguments...);
        void* const status = reinterpret_cast<Signature>(table_[function])(arguments...);
        if (!status)
            return;
        const std::string text = reinterpret_cast<const char* (*)(void*)>(table_[get_error_message])(status);
        release(release_status, status);
        throw EngineError("cannot be run by ONNX Runtime: " + text);
    }

    void release(Function function, void* object) const { reinterpret_cast<void (*)(void*)>(table_[function])(object); }

private:
    using Entry = void (*)();
    struct Base {
        const Entry* (*get_api)(std::uint32_t version);
        const char* (*get_version)();
    };

    static void* load(const std::string& library)
    {
        if (!library.empty())
            return ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
        void* const usual = ::dlopen("libonnxruntime.so.1", RTLD_NOW | RTLD_LOCAL);
        return usual ? usual : ::dlopen("libonnxruntime.so", RTLD_NOW | RTLD_LOCAL);
    }

    const Entry* table_ = nullptr;
};

/// An object of the library.
class Handle {
public:
    Handle(const Api& api, Function release) : api_(api), release_(release) {}
    ~Handle()
    {
        if (object_)
            api_.release(release_, object_);
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    void** place() { return &object_; }
    [[nodiscard]] void* get() const { return object_; }

private:
    const Api& api_;
    Function release_;
    void* object_ = nullptr;
};

class OnnxRuntimeEngine : public Engine {
public:
    OnnxRuntimeEngine(const std::string& model, const std::string& library) : api_(library)
    {
        api_.call(create_env, log_fatal, "hive", env_.place());
        Handle options(api_, release_session_options);
        api_.call(create_session_options, options.place());
        for (const Function threads : {set_intra_op_threads, set_inter_op_threads})
            api_.call(threads, options.get(), 1);  // one drone, one core
        api_.call(create_session, env_.get(), model.c_str(), options.get(), session_.place());
        inputs_ = names(get_input_count, get_input_name);
        wants_size_ = std::erase(inputs_, size_input) > 0;
        if (inputs_.size() != 1)
            throw EngineError("has " + std::to_string(inputs_.size()) + " inputs; its only input has to be the image");
        outputs_ = names(get_output_count, get_output_name);
        api_.call(create_cpu_memory_info, device_allocator, default_memory, memory_.place());
    }

    std::vector<cv::Mat> run(const cv::Mat& input) override
    {
        const std::vector<std::int64_t> sides(input.size.p, input.size.p + input.dims);
        std::array<std::int64_t, 2> size{sides[3], sides[2]};
        Handle image(api_, release_value), image_size(api_, release_value);
        make_tensor(image, input.data, input.total() * input.elemSize(), sides, type_float);
        make_tensor(image_size, size.data(), sizeof size, {1, 2}, type_int64);
        const std::array<const char*, 2> input_names{inputs_[0].c_str(), size_input};
        const std::array<void*, 2> tensors{image.get(), image_size.get()};
        std::vector<const char*> output_names;
        for (const std::string& name : outputs_)
            output_names.push_back(name.c_str());
        std::vector<void*> values(outputs_.size(), nullptr);
        api_.call(run_session, session_.get(), static_cast<void*>(nullptr), input_names.data(), tensors.data(),
                  std::size_t{wants_size_ ? 2U : 1U}, output_names.data(), output_names.size(), values.data());
        return copies(values);
    }

private:
    /// Of these bytes, which are not copied.
    void make_tensor(Handle& tensor, void* data, std::size_t bytes, const std::vector<std::int64_t>& sides,
                     int type) const
    {
        api_.call(create_tensor_with_data, memory_.get(), data, bytes, sides.data(), sides.size(), type,
                  tensor.place());
    }

    std::vector<std::string> names(Function count, Function name) const
    {
        std::size_t number = 0;
        api_.call(count, session_.get(), &number);
        void* allocator = nullptr;
        api_.call(get_default_allocator, &allocator);
        std::vector<std::string> found;
        for (std::size_t i = 0; i < number; ++i) {
            char* text = nullptr;
            api_.call(name, session_.get(), i, allocator, &text);
            found.emplace_back(text);
            api_.call(free_allocated, allocator, static_cast<void*>(text));
        }
        return found;
    }

    std::vector<cv::Mat> copies(const std::vector<void*>& values) const
    {
        std::vector<std::unique_ptr<void, Release>> owned;
        for (void* const value : values)
            owned.emplace_back(value, Release{&api_});
        std::vector<cv::Mat> outputs;
        for (const auto& value : owned)
            outputs.push_back(copy_of(value.get()));
        return outputs;
    }

    cv::Mat copy_of(void* value) const
    {
        Handle info(api_, release_type_and_shape);
        api_.call(get_type_and_shape, value, info.place());
        int type = 0;
        std::size_t count = 0;
        api_.call(get_element_type, info.get(), &type);
        api_.call(get_dimensions_count, info.get(), &count);
        std::vector<std::int64_t> sides(count);
        api_.call(get_dimensions, info.get(), sides.data(), sides.size());
        std::vector<int> shape(sides.begin(), sides.end());
        shape.resize(std::max<std::size_t>(shape.size(), 2), 1);  // OpenCV has no vectors
        void* data = nullptr;
        api_.call(get_tensor_data, value, &data);
        return floats(data, type, cv::Mat(static_cast<int>(shape.size()), shape.data(), CV_32F));
    }

    static cv::Mat floats(const void* data, int type, cv::Mat result)
    {
        const auto fill = [&](const auto* numbers) {
            std::copy(numbers, numbers + result.total(), result.ptr<float>());
            return result;
        };
        switch (type) {
        case type_float: return fill(static_cast<const float*>(data));
        case type_int32: return fill(static_cast<const std::int32_t*>(data));
        case type_int64: return fill(static_cast<const std::int64_t*>(data));
        default: throw EngineError("has an output of numbers that are neither float, int32 nor int64");
        }
    }

    struct Release {
        const Api* api;
        void operator()(void* value) const { api->release(release_value, value); }
    };

    Api api_;
    Handle env_{api_, release_env}, memory_{api_, release_memory_info}, session_{api_, release_session};
    std::vector<std::string> inputs_, outputs_;
    bool wants_size_ = false;
};

}  // namespace

std::unique_ptr<Engine> onnxruntime_engine(const std::string& model, const std::string& library)
{
    return std::make_unique<OnnxRuntimeEngine>(model, library);
}

}  // namespace detect
