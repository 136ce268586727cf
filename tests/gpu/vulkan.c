/* noisefloor_sampler.h in SPIR-V, on every Vulkan device that is there: the bits of the library, and draws per second.
 *
 *   vulkan LANGUAGE SHADER.spv [LANGUAGE SHADER.spv ...]
 */
#include "expected.h"
#include <vulkan/vulkan.h>

static void check(VkResult result, const char *what)
{
    if (result != VK_SUCCESS)
        failed(what, (int)result);
}

typedef struct {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
} block;

/* Memory that both sides see, the device's own where it has such. */
static uint32_t kind_of_memory(VkPhysicalDevice physical, uint32_t allowed)
{
    VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT |
                                   VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    VkPhysicalDeviceMemoryProperties kinds;
    uint32_t k;
    vkGetPhysicalDeviceMemoryProperties(physical, &kinds);
    for (;; wanted &= ~(VkMemoryPropertyFlags)VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) {
        for (k = 0; k < kinds.memoryTypeCount; ++k)
            if (allowed >> k & 1 && (kinds.memoryTypes[k].propertyFlags & wanted) == wanted)
                return k;
        if (!(wanted & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT))
            failed("memory that both sides see", 0);
    }
}

static block make_block(VkPhysicalDevice physical, VkDevice device, VkDeviceSize bytes)
{
    VkBufferCreateInfo buffer = {VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    VkMemoryAllocateInfo allocate = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    VkMemoryRequirements needs;
    block made;
    buffer.size = bytes;
    buffer.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    check(vkCreateBuffer(device, &buffer, NULL, &made.buffer), "buffer");
    vkGetBufferMemoryRequirements(device, made.buffer, &needs);
    allocate.allocationSize = needs.size;
    allocate.memoryTypeIndex = kind_of_memory(physical, needs.memoryTypeBits);
    check(vkAllocateMemory(device, &allocate, NULL, &made.memory), "memory");
    check(vkBindBufferMemory(device, made.buffer, made.memory, 0), "memory");
    check(vkMapMemory(device, made.memory, 0, bytes, 0, &made.mapped), "memory");
    return made;
}

static VkShaderModule load(VkDevice device, const char *path)
{
    VkShaderModuleCreateInfo create = {VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    static uint32_t words[1 << 16];
    VkShaderModule module;
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        failed(path, 0);
    create.codeSize = fread(words, 1, sizeof words, file);
    create.pCode = words;
    fclose(file);
    check(vkCreateShaderModule(device, &create, NULL, &module), path);
    return module;
}

/* How many of the draws differ. */
static size_t draw_on(VkPhysicalDevice physical, const char *language, const char *path)
{
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queues = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    VkDeviceCreateInfo create = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    VkDescriptorSetLayoutBinding bindings[2] = {{0}};
    VkDescriptorSetLayoutCreateInfo set_layout = {VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(uint32_t)};
    VkPipelineLayoutCreateInfo layout = {VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    VkComputePipelineCreateInfo compute = {VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2};
    VkDescriptorPoolCreateInfo pool = {VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    VkDescriptorSetAllocateInfo allocate = {VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    VkCommandPoolCreateInfo commands = {VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandBufferAllocateInfo command = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    VkPhysicalDeviceProperties properties;
    VkDevice device;
    VkQueue queue;
    VkDescriptorSetLayout set_layout_made;
    VkPipelineLayout layout_made;
    VkPipeline pipeline;
    VkDescriptorPool pool_made;
    VkDescriptorSet set;
    VkCommandPool commands_made;
    VkCommandBuffer buffer;
    block table, out;
    static float drawn[AT_ONCE * 8];
    size_t different = 0;
    uint32_t round, k;
    double time = 0.0;

    vkGetPhysicalDeviceProperties(physical, &properties);
    queues.queueCount = 1; /* of family 0, which computes on all that there are */
    queues.pQueuePriorities = &priority;
    create.queueCreateInfoCount = 1;
    create.pQueueCreateInfos = &queues;
    check(vkCreateDevice(physical, &create, NULL, &device), "device");
    vkGetDeviceQueue(device, 0, 0, &queue);

    table = make_block(physical, device, 65536 * sizeof(uint32_t));
    out = make_block(physical, device, BYTES);
    memcpy(table.mapped, nf_sampler_table(), 65536 * sizeof(uint32_t));

    for (k = 0; k < 2; ++k) {
        bindings[k].binding = k;
        bindings[k].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        bindings[k].descriptorCount = 1;
        bindings[k].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    }
    set_layout.bindingCount = 2;
    set_layout.pBindings = bindings;
    check(vkCreateDescriptorSetLayout(device, &set_layout, NULL, &set_layout_made), "layout");
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &set_layout_made;
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &push;
    check(vkCreatePipelineLayout(device, &layout, NULL, &layout_made), "layout");
    compute.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    compute.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    compute.stage.module = load(device, path);
    compute.stage.pName = "main";
    compute.layout = layout_made;
    check(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &compute, NULL, &pipeline), "pipeline");
    pool.maxSets = 1;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    check(vkCreateDescriptorPool(device, &pool, NULL, &pool_made), "pool");
    allocate.descriptorPool = pool_made;
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &set_layout_made;
    check(vkAllocateDescriptorSets(device, &allocate, &set), "set");
    for (k = 0; k < 2; ++k) {
        const VkDescriptorBufferInfo whole = {k == 0 ? table.buffer : out.buffer, 0, VK_WHOLE_SIZE};
        VkWriteDescriptorSet write = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set;
        write.dstBinding = k;
        write.descriptorCount = 1;
        write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        write.pBufferInfo = &whole;
        vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    }
    commands.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    check(vkCreateCommandPool(device, &commands, NULL, &commands_made), "commands");
    command.commandPool = commands_made;
    command.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    command.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device, &command, &buffer), "commands");

    for (round = 0; round < ROUNDS; ++round) {
        const uint32_t first = round * AT_ONCE;
        VkCommandBufferBeginInfo begin = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
        VkSubmitInfo submit = {VK_STRUCTURE_TYPE_SUBMIT_INFO};
        double start;
        check(vkBeginCommandBuffer(buffer, &begin), "commands");
        vkCmdBindPipeline(buffer, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
        vkCmdBindDescriptorSets(buffer, VK_PIPELINE_BIND_POINT_COMPUTE, layout_made, 0, 1, &set, 0, NULL);
        vkCmdPushConstants(buffer, layout_made, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof first, &first);
        vkCmdDispatch(buffer, AT_ONCE / 64, 1, 1);
        check(vkEndCommandBuffer(buffer), "commands");
        submit.commandBufferCount = 1;
        submit.pCommandBuffers = &buffer;
        start = seconds();
        check(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE), "run");
        check(vkQueueWaitIdle(queue), "run");
        time += round > 0 ? seconds() - start : 0.0;
        memcpy(drawn, out.mapped, BYTES); /* at once: a device's memory is slow to read */
        different += differences(first, drawn);
    }
    report_device(properties.deviceName, language, different, time);
    vkDestroyDevice(device, NULL);
    return different;
}

int main(int argc, char **argv)
{
    VkApplicationInfo application = {VK_STRUCTURE_TYPE_APPLICATION_INFO};
    VkInstanceCreateInfo create = {VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    VkInstance instance;
    VkPhysicalDevice all[8];
    uint32_t count = 8, d;
    size_t different = 0;
    int k;
    application.apiVersion = VK_API_VERSION_1_1;
    create.pApplicationInfo = &application;
    check(vkCreateInstance(&create, NULL, &instance), "instance");
    check(vkEnumeratePhysicalDevices(instance, &count, all), "devices");
    for (d = 0; d < count; ++d)
        for (k = 1; k + 1 < argc; k += 2)
            different += draw_on(all[d], argv[k], argv[k + 1]);
    if (count == 0)
        fprintf(stderr, "no Vulkan device\n");
    vkDestroyInstance(instance, NULL);
    return count == 0 || different > 0;
}
