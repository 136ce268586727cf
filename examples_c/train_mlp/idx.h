/* Images and labels in IDX files, MNIST's format: big-endian numbers, then bytes. */
#ifndef TRAIN_MLP_IDX_H
#define TRAIN_MLP_IDX_H

#include "common.h"

typedef struct dataset {
    uint32_t items;
    uint32_t pixels;  /* of one image */
    uint8_t *images;  /* [items * pixels] */
    uint8_t *labels;  /* [items] */
    uint32_t classes; /* the largest label, plus one */
} dataset;

/* The whole file's bytes after its header of 4 * (1 + dims) bytes; `sizes` gets the dims numbers. The file must be
   exactly as long as its header says. */
static uint8_t *idx_read(const char *folder, const char *name, uint32_t dims, uint32_t *sizes)
{
    size_t length = strlen(folder) + strlen(name) + 2;
    char *path = allocate(length, 1);
    snprintf(path, length, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        fail("cannot open %s", path);
    uint64_t bytes = 1;
    for (uint32_t field = 0; field <= dims; ++field) {
        uint8_t b[4];
        if (fread(b, 1, 4, file) != 4)
            fail("%s ends in its header", path);
        uint32_t value = (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
        if (field == 0) { /* 0x08: unsigned bytes */
            if (value != (0x800u | dims))
                fail("%s is no IDX file of bytes in %u dimension%s", path, dims, dims > 1 ? "s" : "");
            continue;
        }
        if (value == 0 || bytes > ((uint64_t)1 << 40) / value)
            fail("%s: its header says that there are %s", path, value == 0 ? "no data" : "more data than can be");
        sizes[field - 1] = value;
        bytes *= value;
    }
    /* Before the memory is asked for: a broken header may say anything. */
    long start = ftell(file);
    if (start < 0 || fseek(file, 0, SEEK_END) != 0)
        fail("cannot read %s", path);
    long end = ftell(file);
    if (end < start || (uint64_t)(end - start) != bytes)
        fail("%s holds %ld bytes of data; its header says %.0f", path, end - start, (double)bytes);
    if (fseek(file, start, SEEK_SET) != 0)
        fail("cannot read %s", path);
    uint8_t *data = allocate((size_t)bytes, 1);
    if (fread(data, 1, (size_t)bytes, file) != bytes)
        fail("cannot read %s", path);
    fclose(file);
    free(path);
    return data;
}

/* FOLDER/PART-images-idx3-ubyte and FOLDER/PART-labels-idx1-ubyte. */
static dataset dataset_read(const char *folder, const char *part)
{
    char images[64], labels[64];
    snprintf(images, sizeof images, "%s-images-idx3-ubyte", part);
    snprintf(labels, sizeof labels, "%s-labels-idx1-ubyte", part);
    uint32_t sizes[3], count;
    dataset data = {0};
    data.images = idx_read(folder, images, 3, sizes);
    data.labels = idx_read(folder, labels, 1, &count);
    if (count != sizes[0])
        fail("%s/%s has %u images, but %s has %u labels", folder, images, sizes[0], labels, count);
    if ((uint64_t)sizes[1] * sizes[2] > 1u << 20)
        fail("%s/%s: images of %u x %u pixels are too large", folder, images, sizes[1], sizes[2]);
    data.items = count;
    data.pixels = sizes[1] * sizes[2];
    for (uint32_t i = 0; i < count; ++i)
        if (data.labels[i] >= data.classes)
            data.classes = data.labels[i] + 1u;
    return data;
}

static void dataset_free(dataset *data)
{
    free(data->images);
    free(data->labels);
}

#endif
